/** Writes a word with a dark edge, centered at (x, y) or, where the canvas ends, as near to it as it is not cut. */
export function drawLabel(context: CanvasRenderingContext2D, text: string, x: number, y: number, edge: { color: string; width: number }, color: string): void {
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  context.lineWidth = edge.width;
  context.strokeStyle = edge.color;
  const { width, actualBoundingBoxAscent: above, actualBoundingBoxDescent: below } = context.measureText(text);
  const inside = (value: number, before: number, after: number, most: number) => Math.max(before, Math.min(most - after, value));
  const margin = (width + edge.width) / 2;
  const [left, top] = [inside(x, margin, margin, context.canvas.width), inside(y, above + edge.width / 2, below + edge.width / 2, context.canvas.height)];
  context.strokeText(text, left, top);
  context.fillStyle = color;
  context.fillText(text, left, top);
}

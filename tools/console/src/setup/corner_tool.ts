import type { PictureTool } from '../lib/picture_tool';

export type Corner = [number, number];

/** In the picture's order: -x-y is below on the left if x points to the right. */
export const CORNER_NAMES = ['left below', 'right below', 'right above', 'left above'];

/** Corners of a field that fills most of the picture. */
export function initialCorners(width: number, height: number): Corner[] {
  const [left, right, top, bottom] = [0.15 * width, 0.85 * width, 0.15 * height, 0.85 * height];
  return [[left, bottom], [right, bottom], [right, top], [left, top]];
}

export interface CornerHandlers {
  choose(index: number | null): void;
  move(index: number, corner: Corner): void;
  /** Nobody moves a corner any more. */
  moved(): void;
}

// The tool is made anew whenever a corner moves; the finger that holds one stays the same.
let grabbed: { index: number; offset: Corner } | null = null;

/** Draws the corners and the model's lines; corners are dragged, or chosen with 1 to 4 and moved with the arrow keys. */
export function cornerTool(corners: Corner[] | null, chosen: number | null, magnified: boolean, lines: [number, number][][], handlers: CornerHandlers): PictureTool {
  return {
    fullResolution: corners !== null,
    draw(context, { toCanvas, unit }) {
      const stroke = (points: [number, number][], color: string, width: number, dash: number[] = []) => {
        if (points.length < 2) return;
        context.beginPath();
        points.forEach(([u, v], i) => (i === 0 ? context.moveTo(...toCanvas(u, v)) : context.lineTo(...toCanvas(u, v))));
        context.setLineDash(dash.map((length) => length * unit));
        context.strokeStyle = 'rgb(0 0 0 / 0.6)';
        context.lineWidth = (width + 2) * unit;
        context.stroke();
        context.strokeStyle = color;
        context.lineWidth = width * unit;
        context.stroke();
        context.setLineDash([]);
      };
      for (const line of lines) stroke(line, '#ffe14a', 1.75);
      if (!corners) return;
      if (lines.length === 0) stroke([...corners, corners[0]!], '#ffffff', 1.5, [6, 5]);
      corners.forEach((corner, i) => {
        const [x, y] = toCanvas(...corner);
        context.beginPath();
        context.arc(x, y, 13 * unit, 0, 2 * Math.PI);
        context.strokeStyle = '#000000';
        context.lineWidth = 5 * unit;
        context.stroke();
        context.strokeStyle = i === chosen ? '#ffe14a' : '#ffffff';
        context.lineWidth = 3 * unit;
        context.stroke();
        context.font = `700 ${13 * unit}px system-ui, sans-serif`;
        context.textAlign = 'center';
        context.textBaseline = 'middle';
        context.lineWidth = 3 * unit;
        context.strokeStyle = '#000000';
        const below = y < 40 * unit ? 26 : -26;
        context.strokeText(String(i + 1), x, y + below * unit);
        context.fillStyle = '#ffffff';
        context.fillText(String(i + 1), x, y + below * unit);
      });
    },
    magnified: () => (corners && magnified && chosen !== null ? (corners[chosen] ?? null) : null),
    grab(u, v, reach) {
      if (!corners) return false;
      const distances = corners.map(([cu, cv]) => Math.hypot(cu - u, cv - v));
      const nearest = distances.indexOf(Math.min(...distances));
      const corner = corners[nearest]!;
      if (distances[nearest]! > reach) return false;
      // The corner keeps its place under the finger, wherever the finger took hold.
      grabbed = { index: nearest, offset: [corner[0] - u, corner[1] - v] };
      handlers.choose(nearest);
      return true;
    },
    drag(u, v) {
      if (grabbed) handlers.move(grabbed.index, [u + grabbed.offset[0], v + grabbed.offset[1]]);
    },
    release() {
      grabbed = null;
      handlers.moved();
    },
    key(event) {
      if (!corners) return false;
      const digit = '1234'.indexOf(event.key);
      if (event.key.length === 1 && digit >= 0) {
        handlers.choose(digit);
        return true;
      }
      if (chosen === null) return false;
      if (event.key === 'Escape') {
        handlers.choose(null);
        return true;
      }
      const step = event.shiftKey ? 10 : 0.5;
      const steps: Record<string, Corner> = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
      const by = steps[event.key];
      const corner = corners[chosen];
      if (!by || !corner) return false;
      handlers.move(chosen, [corner[0] + by[0], corner[1] + by[1]]);
      handlers.moved();
      return true;
    },
  };
}

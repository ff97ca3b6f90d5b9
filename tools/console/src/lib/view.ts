/** Zoom and pan of the picture. At zoom 1 the whole picture fits the canvas. */
export interface View {
  zoom: number;
  x: number; // of the picture's center, in canvas pixels from the canvas' center
  y: number;
}

export const FIT: View = { zoom: 1, x: 0, y: 0 };
export const MAX_ZOOM = 24;

export interface Size {
  width: number;
  height: number;
}

/** Scale from picture to canvas at zoom 1. */
export function fitScale(canvas: Size, picture: Size): number {
  return Math.min(canvas.width / picture.width, canvas.height / picture.height);
}

/** Keeps the picture over the canvas: an edge never comes farther inside than it is at zoom 1. */
function bounded(view: View, canvas: Size, picture: Size): View {
  const zoom = Math.min(Math.max(view.zoom, 1), MAX_ZOOM);
  const scale = fitScale(canvas, picture) * zoom;
  const reachX = Math.max(0, (picture.width * scale - canvas.width) / 2);
  const reachY = Math.max(0, (picture.height * scale - canvas.height) / 2);
  return { zoom, x: Math.min(Math.max(view.x, -reachX), reachX) + 0, y: Math.min(Math.max(view.y, -reachY), reachY) + 0 };
}

/** Zooms by a factor; the point of the picture under (x, y) of the canvas stays there. */
export function zoomAt(view: View, factor: number, x: number, y: number, canvas: Size, picture: Size): View {
  const zoom = Math.min(Math.max(view.zoom * factor, 1), MAX_ZOOM);
  const ratio = zoom / view.zoom;
  const [dx, dy] = [x - canvas.width / 2, y - canvas.height / 2];
  return bounded({ zoom, x: dx - (dx - view.x) * ratio, y: dy - (dy - view.y) * ratio }, canvas, picture);
}

export function pan(view: View, dx: number, dy: number, canvas: Size, picture: Size): View {
  return bounded({ ...view, x: view.x + dx, y: view.y + dy }, canvas, picture);
}

/** Pixels of the picture, (0, 0) at its top-left corner, to canvas pixels. */
export function toCanvas(view: View, u: number, v: number, canvas: Size, picture: Size): [number, number] {
  const scale = fitScale(canvas, picture) * view.zoom;
  return [canvas.width / 2 + view.x + (u - picture.width / 2) * scale, canvas.height / 2 + view.y + (v - picture.height / 2) * scale];
}

/** The reverse of toCanvas. */
export function fromCanvas(view: View, x: number, y: number, canvas: Size, picture: Size): [number, number] {
  const scale = fitScale(canvas, picture) * view.zoom;
  return [(x - canvas.width / 2 - view.x) / scale + picture.width / 2, (y - canvas.height / 2 - view.y) / scale + picture.height / 2];
}

/** Moves the view until the picture's point (u, v) is at least `margin` canvas pixels inside the canvas, as far as it can. */
export function reveal(view: View, u: number, v: number, margin: number, canvas: Size, picture: Size): View {
  const [x, y] = toCanvas(view, u, v, canvas, picture);
  const inside = (value: number, most: number) => Math.min(Math.max(value, margin), most - margin) - value;
  return pan(view, inside(x, canvas.width), inside(y, canvas.height), canvas, picture);
}

import type { PictureTool } from './picture_tool';

type Pixel = [number, number];
/** From where to where an object is being moved, in pixels of the camera's full picture. */
export interface Move {
  from: Pixel;
  to: Pixel;
}

/** Draws what is being moved. `changed`: null when it ends; `moved`: where it is put down. */
export function moveTool(move: Move | null, changed: (move: Move | null) => void, moved: (from: Pixel, to: Pixel) => void): PictureTool {
  return {
    draw(context, { toCanvas, unit }) {
      if (!move) return;
      const [from, to] = [toCanvas(...move.from), toCanvas(...move.to)];
      for (const [color, width] of [['#000000', 5], ['#ffe14a', 2.5]] as const) {
        context.strokeStyle = color;
        context.lineWidth = width * unit;
        context.beginPath();
        context.moveTo(...from);
        context.lineTo(...to);
        context.stroke();
        context.beginPath();
        context.arc(...to, 12 * unit, 0, 2 * Math.PI);
        context.stroke();
      }
    },
    grab(u, v) {
      changed({ from: [u, v], to: [u, v] });
      return true;
    },
    drag(u, v) {
      if (move) changed({ from: move.from, to: [u, v] });
    },
    release() {
      if (move && (move.from[0] !== move.to[0] || move.from[1] !== move.to[1])) moved(move.from, move.to);
      changed(null);
    },
  };
}

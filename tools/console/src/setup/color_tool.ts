import type { PictureTool } from '../lib/picture_tool';

interface Click {
  u_px: number;
  v_px: number;
  used?: boolean;
}

/** Shows the catch of a color over a picture, and reports clicks on it. */
export function colorTool(still: ImageBitmap | null, mask: ImageBitmap | null, clicks: Click[], click: (u: number, v: number) => void): PictureTool {
  return {
    still,
    fullResolution: true,
    draw(context, { toCanvas, unit, picture }) {
      if (mask) {
        context.imageSmoothingEnabled = false;
        context.drawImage(mask, ...picture);
      }
      for (const { u_px, v_px, used } of clicks) {
        const [x, y] = toCanvas(u_px, v_px);
        for (const [color, width] of [['#000000', 4], [used === false ? '#ff9a94' : '#ffffff', 2]] as const) {
          context.beginPath();
          context.arc(x, y, 7 * unit, 0, 2 * Math.PI);
          context.strokeStyle = color;
          context.lineWidth = width * unit;
          context.stroke();
        }
      }
    },
    click,
  };
}

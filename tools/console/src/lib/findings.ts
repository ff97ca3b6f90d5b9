import type { Rgb } from './message_types';

/** Classes or light of a picture: values in raster order, each for a rectangle of the picture. */
export interface ValueGrid {
  columns: number;
  rows: number;
  values: Uint8Array;
  tile: [number, number]; // width and height of a value's rectangle, in pixels of the camera
}

/** Pixels that are outside the region of interest. */
export const OUTSIDE = 255;
const LEVELS_PER_OCTAVE = 32;
const NEUTRAL_LEVEL = 64;

/** Expands runs of three bytes: length (u16, little-endian) and value. Returns null if they are not exactly as many values. */
export function expandRuns(runs: DataView, count: number): Uint8Array | null {
  const values = new Uint8Array(count);
  let done = 0;
  for (let i = 0; i + 3 <= runs.byteLength; i += 3) {
    const length = runs.getUint16(i, true);
    if (done + length > count) return null;
    values.fill(runs.getUint8(i + 2), done, done + length);
    done += length;
  }
  return done === count && runs.byteLength % 3 === 0 ? values : null;
}

/** Light at a tile relative to the place where the colors were learned: values are corrected by its inverse. */
export const lightOfLevel = (level: number): number => 2 ** ((NEUTRAL_LEVEL - level) / LEVELS_PER_OCTAVE);

function paint({ columns, rows, values }: ValueGrid, colorOf: (value: number) => readonly [number, number, number, number]): HTMLCanvasElement {
  const canvas = document.createElement('canvas');
  canvas.width = columns;
  canvas.height = rows;
  const context = canvas.getContext('2d')!;
  const image = context.createImageData(columns, rows);
  const known = new Map<number, readonly number[]>();
  values.forEach((value, i) => {
    let color = known.get(value);
    if (!color) known.set(value, (color = colorOf(value)));
    image.data.set(color, 4 * i);
  });
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Background is darkened, what the camera does not look at nearly black. */
export const paintClasses = (grid: ValueGrid, colors: readonly Rgb[]): HTMLCanvasElement =>
  paint(grid, (value) => {
    if (value === 0) return [0, 0, 0, 120];
    if (value === OUTSIDE) return [0, 0, 0, 205];
    const rgb = colors[value - 1] ?? [255, 255, 255];
    return [rgb[0], rgb[1], rgb[2], 255];
  });

/** Bright places are yellow, dark ones blue; half or twice the light is strong. */
export const paintLight = (grid: ValueGrid): HTMLCanvasElement =>
  paint(grid, (level) => {
    const octaves = Math.log2(lightOfLevel(level));
    const alpha = Math.round(Math.min(1, Math.abs(octaves)) * 190);
    return octaves > 0 ? [255, 222, 40, alpha] : [30, 70, 255, alpha];
  });

/** Darkest and brightest tile. */
export function lightRange({ values }: ValueGrid): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const level of values) {
    low = Math.min(low, lightOfLevel(level));
    high = Math.max(high, lightOfLevel(level));
  }
  return [low, high];
}

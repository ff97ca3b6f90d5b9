import type { Projection } from './protocol';

export interface PixelPoint {
  u: number;
  v: number;
}
export interface FieldPoint {
  x: number;
  y: number;
}

/** Maps field points to pixels of the full camera picture and back, by bilinear interpolation of the server's grid. */
export class PixelMap {
  constructor(private readonly grid: Projection) {}

  /** The pixel of a field point at the height closest to `height_m`; null outside the grid or where the camera sees nothing. */
  toPixel(x: number, y: number, height_m = 0): PixelPoint | null {
    return this.cell(x, y, height_m)?.pixel ?? null;
  }

  /** The field point at the height closest to `height_m` that a pixel shows; null outside the grid. */
  toField(u: number, v: number, height_m = 0): FieldPoint | null {
    const { x_min_m, y_min_m, step_m, columns, rows } = this.grid;
    const x_max = x_min_m + (columns - 1) * step_m;
    const y_max = y_min_m + (rows - 1) * step_m;
    let x = (x_min_m + x_max) / 2;
    let y = (y_min_m + y_max) / 2;
    // Newton's method on a map that is nearly affine: a few steps reach a hundredth of a pixel.
    for (let step = 0; step < 20; step += 1) {
      const cell = this.cell(x, y, height_m);
      if (!cell) return null;
      const du = u - cell.pixel.u;
      const dv = v - cell.pixel.v;
      if (Math.hypot(du, dv) < 0.01) return { x, y };
      const det = cell.ux * cell.vy - cell.uy * cell.vx;
      if (Math.abs(det) < 1e-9) return null;
      const nextX = x + (cell.vy * du - cell.uy * dv) / det;
      const nextY = y + (cell.ux * dv - cell.vx * du) / det;
      // Outside the grid only by a step that overshoots; a point that stays outside ends the search.
      const boundedX = Math.min(Math.max(nextX, x_min_m), x_max);
      const boundedY = Math.min(Math.max(nextY, y_min_m), y_max);
      if (boundedX === x && boundedY === y) return null;
      x = boundedX;
      y = boundedY;
    }
    return null;
  }

  private cell(x: number, y: number, height_m: number) {
    const { x_min_m, y_min_m, step_m, columns, rows, planes } = this.grid;
    let plane = planes[0];
    for (const candidate of planes) {
      if (plane && Math.abs(candidate.height_m - height_m) < Math.abs(plane.height_m - height_m)) plane = candidate;
    }
    if (!plane) return null;
    const column = (x - x_min_m) / step_m;
    const row = (y - y_min_m) / step_m;
    const tolerance = 1e-6;
    if (!(column >= -tolerance && column <= columns - 1 + tolerance && row >= -tolerance && row <= rows - 1 + tolerance)) return null;
    const c = Math.min(Math.max(Math.floor(column), 0), columns - 2);
    const r = Math.min(Math.max(Math.floor(row), 0), rows - 2);
    const s = column - c;
    const t = row - r;
    const values: number[] = [];
    for (const [dc, dr] of [[0, 0], [1, 0], [0, 1], [1, 1]] as const) {
      const at = 2 * ((r + dr) * columns + c + dc);
      const u = plane.uv_px[at];
      const v = plane.uv_px[at + 1];
      if (u === null || u === undefined || v === null || v === undefined) return null;
      values.push(u, v);
    }
    const [u00, v00, u10, v10, u01, v01, u11, v11] = values as [number, number, number, number, number, number, number, number];
    const mix = (a: number, b: number, f: number) => a + (b - a) * f;
    return {
      pixel: { u: mix(mix(u00, u10, s), mix(u01, u11, s), t), v: mix(mix(v00, v10, s), mix(v01, v11, s), t) },
      ux: mix(u10 - u00, u11 - u01, t) / step_m,
      uy: mix(u01 - u00, u11 - u10, s) / step_m,
      vx: mix(v10 - v00, v11 - v01, t) / step_m,
      vy: mix(v01 - v00, v11 - v10, s) / step_m,
    };
  }
}

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { fieldLines } from '../../../tools/console/src/lib/field_lines';
import { ellipse } from '../../../tools/console/src/lib/overlay';
import { PixelMap } from '../../../tools/console/src/lib/projection';
import type { Projection } from '../../../tools/console/src/lib/protocol';
import { FIT, fromCanvas, MAX_ZOOM, pan, toCanvas, zoomAt } from '../../../tools/console/src/lib/view';

// The arena's camera, looking straight down: 559 pixels focal length, 2.3 m high, k1 = -0.36.
function camera(x: number, y: number, height_m: number): [number, number] {
  const [a, b] = [x / (2.3 - height_m), y / (2.3 - height_m)];
  const k = 559 * (1 - 0.36 * (a * a + b * b));
  return [319.5 + k * a, 239.5 - k * b];
}
function grid(hidden: (x: number, y: number) => boolean = () => false): Projection {
  const [columns, rows, step_m] = [27, 21, 0.1];
  const plane = (height_m: number) => {
    const uv_px: (number | null)[] = [];
    for (let row = 0; row < rows; row += 1) {
      for (let column = 0; column < columns; column += 1) {
        const [x, y] = [-1.3 + column * step_m, -1 + row * step_m];
        uv_px.push(...(hidden(x, y) ? [null, null] : camera(x, y, height_m)));
      }
    }
    return { height_m, uv_px };
  };
  return { x_min_m: -1.3, y_min_m: -1, step_m, columns, rows, planes: [plane(0), plane(0.05)] };
}

test('interpolation between grid points is within 0.3 pixels of the camera model', () => {
  const map = new PixelMap(grid());
  let worst = 0;
  for (let x = -1.29; x < 1.3; x += 0.037) {
    for (let y = -0.99; y < 1; y += 0.041) {
      for (const height of [0, 0.05]) {
        const pixel = map.toPixel(x, y, height)!;
        const [u, v] = camera(x, y, height);
        worst = Math.max(worst, Math.hypot(pixel.u - u, pixel.v - v));
      }
    }
  }
  assert.ok(worst > 0.01 && worst < 0.3, `${worst} px`);
});

test('a pixel leads back to its field point', () => {
  const map = new PixelMap(grid());
  for (const [x, y] of [[0, 0], [1.05, -0.85], [-1.25, 0.95], [0.333, 0.777]] as const) {
    const pixel = map.toPixel(x, y)!;
    const point = map.toField(pixel.u, pixel.v)!;
    assert.ok(Math.hypot(point.x - x, point.y - y) < 1e-4);
  }
  assert.equal(map.toField(-500, 240), null);
  assert.equal(map.toPixel(1.31, 0), null);
});

test('what the camera does not see has no pixel', () => {
  const map = new PixelMap(grid((x) => x > 0.95));
  assert.equal(map.toPixel(0.95, 0), null);
  assert.notEqual(map.toPixel(0.85, 0), null);
});

test('the ellipse has three standard deviations along its axes', () => {
  const points = ellipse(1, 2, 0.04, 0.01, 0);
  assert.ok(Math.abs(Math.max(...points.map(([x]) => x)) - 1.6) < 1e-9);
  assert.ok(Math.abs(Math.max(...points.map(([, y]) => y)) - 2.3) < 1e-9);
  // Fully correlated errors lie on a line.
  for (const [x, y] of ellipse(0, 0, 0.01, 0.01, 0.01)) assert.ok(Math.abs(x - y) < 1e-9);
});

test('field lines are dense, and their corners are those of the field', () => {
  const lines = fieldLines({ length_m: 2.2, width_m: 1.8, goal_width_m: 0.4, goal_depth_m: 0.15 });
  for (const line of lines) {
    line.slice(1).forEach((point, i) => assert.ok(Math.hypot(point[0] - line[i]![0], point[1] - line[i]![1]) < 0.0501));
  }
  assert.equal(Math.max(...lines.flat().map(([x]) => x)), 1.25);
  assert.equal(fieldLines({ length_m: 2.2, width_m: 1.8, goal_width_m: 0.4, goal_depth_m: 0.15, center_circle_m: 0.25 }).length, lines.length + 1);
});

test('zooming keeps the point under the pointer, and the picture stays over the canvas', () => {
  const [canvas, picture] = [{ width: 800, height: 600 }, { width: 640, height: 480 }];
  const before = fromCanvas(FIT, 250, 320, canvas, picture);
  const view = zoomAt(FIT, 3, 250, 320, canvas, picture);
  const after = fromCanvas(view, 250, 320, canvas, picture);
  assert.ok(Math.hypot(after[0] - before[0], after[1] - before[1]) < 1e-9);
  const back = toCanvas(view, after[0], after[1], canvas, picture);
  assert.ok(Math.hypot(back[0] - 250, back[1] - 320) < 1e-9);
  assert.deepEqual(fromCanvas(pan(view, 1e6, 1e6, canvas, picture), 0, 0, canvas, picture), [0, 0]);
  assert.equal(zoomAt(view, 1e6, 0, 0, canvas, picture).zoom, MAX_ZOOM);
  assert.deepEqual(zoomAt(view, 1e-6, 0, 0, canvas, picture), FIT);
});

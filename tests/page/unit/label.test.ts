// Words on a canvas.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { drawLabel } from '../../../tools/console/src/lib/canvas_label';

/** Where the word is written. Each letter is 10 pixels wide, 8 above and 4 below the middle. */
function placed(text: string, x: number, y: number): [number, number] {
  let at: [number, number] = [NaN, NaN];
  const context = {
    canvas: { width: 200, height: 100 },
    measureText: (word: string) => ({ width: 10 * word.length, actualBoundingBoxAscent: 8, actualBoundingBoxDescent: 4 }),
    strokeText() {},
    fillText(_: string, left: number, top: number) {
      at = [left, top];
    },
  };
  drawLabel(context as unknown as CanvasRenderingContext2D, text, x, y, { color: '#000', width: 2 }, '#fff');
  return at;
}

test('a label is not cut at the edge of the map', () => {
  assert.deepEqual(placed('goalkeeper', 100, 50), [100, 50]);
  assert.deepEqual(placed('goalkeeper', 3, 50), [51, 50]);
  assert.deepEqual(placed('goalkeeper', 198, 50), [149, 50]);
  assert.deepEqual(placed('0', 100, -5), [100, 9]);
  assert.deepEqual(placed('0', 100, 104), [100, 95]);
});

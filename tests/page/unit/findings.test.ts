import assert from 'node:assert/strict';
import { test } from 'node:test';
import { expandRuns, lightOfLevel, lightRange } from '../../../tools/console/src/lib/findings';
import { findingsOf } from '../../../tools/console/src/lib/layers';

const runs = (...bytes: number[]) => new DataView(new Uint8Array(bytes).buffer);

test('runs become values, and damaged ones nothing', () => {
  assert.deepEqual([...expandRuns(runs(2, 0, 7, 1, 0, 255), 3)!], [7, 7, 255]);
  assert.equal(expandRuns(runs(0, 1, 4), 256)!.filter((value) => value === 4).length, 256);
  for (const damaged of [runs(2, 0, 7), runs(4, 0, 7), runs(3, 0, 7, 0), runs()]) assert.equal(expandRuns(damaged, 3), null);
});

test('a level of the light map is the inverse of the correction', () => {
  assert.equal(lightOfLevel(64), 1);
  assert.equal(lightOfLevel(32), 2);
  assert.deepEqual(lightRange({ columns: 2, rows: 1, values: new Uint8Array([96, 64]), tile: [16, 8] }), [0.5, 1]);
});

test('only what a layer needs is asked for', () => {
  assert.deepEqual(findingsOf(new Set(['robots', 'interest'])), []);
  assert.deepEqual(findingsOf(new Set(['refusals', 'light', 'classes'])), ['classes', 'regions', 'light']);
});

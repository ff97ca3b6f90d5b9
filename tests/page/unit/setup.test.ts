// What the page makes of states and files of the setup.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { completeState } from '../../../tools/console/src/lib/setup_defaults';
import type { SetupState } from '../../../tools/console/src/lib/setup_protocol';
import { pieces } from '../../../tools/console/src/setup/exchange';

test('members that an older setup program does not send are filled in', () => {
  const state = completeState({ open: true, steps: { field: { done: true, quality: { level: 'ok', text: '0.3 mm' }, values: null, rms_mm: 0.3 } } } as unknown as Partial<SetupState>);
  assert.equal(state.open, true);
  assert.deepEqual(state.undo, []);
  assert.equal(state.steps.field.done, true);
  assert.equal(state.steps.field.rms_mm, 0.3);
  assert.deepEqual(state.steps.field.values, {});
  assert.deepEqual(state.steps.field.presets, []);
  assert.equal(state.steps.colors.done, false);
  assert.deepEqual(state.steps.robots.own.robots, []);
  assert.equal(completeState({}).steps.radio.quality.level, 'none');
});

test('an import is cut into pieces, never within a character', () => {
  const text = `a${'\u{1f916}'.repeat(5)}b`;
  for (const size of [2, 3, 4, 100]) {
    const parts = pieces(text, size);
    assert.equal(parts.join(''), text);
    assert.ok(parts.every((part) => part.length <= size && !/[\ud800-\udbff]$/.test(part)), `${size}`);
  }
  assert.deepEqual(pieces('', 10), ['']);
});

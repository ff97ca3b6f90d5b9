import assert from 'node:assert/strict';
import { test } from 'node:test';
import { haltReasons, reasonsToShow } from '../../../tools/console/src/lib/halts';

test('after a setup nobody has pressed Stop', () => {
  assert.equal(haltReasons(['console', 'setup_ended']), 'the setup has ended');
  assert.deepEqual(reasonsToShow(['no_frames', 'console', 'setup_ended']), ['no_frames', 'setup_ended']);
  assert.equal(haltReasons(['console']), 'Stop was pressed, or the page with control was closed');
});

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { FAULTS, faultOf, throwOf, within } from '../../../tools/console/src/lib/arena';

test('the faults are those of the arena', () => {
  const source = readFileSync('../../../hal/mock/arena_parameters.h', 'utf8');
  const table = /kFaultKinds\{\{([^;]*)\}\};/.exec(source)![1]!;
  assert.deepEqual([...table.matchAll(/"(\w+)"/g)].map(([, word]) => word), [...FAULTS]);
});

test('only the fault that hides a robot names one', () => {
  const robot = { team: 'opponent', id: 3 } as const;
  assert.deepEqual(faultOf('hide_robot', 0.3, robot), { fault: { kind: 'hide_robot', for_s: 0.3, team: 'opponent', id: 3 } });
  assert.deepEqual(faultOf('dark', 2, robot), { fault: { kind: 'dark', for_s: 2 } });
});

test('a throw has the direction counter-clockwise from x', () => {
  assert.deepEqual(throwOf(2, 90), { throw: { vx: 0, vy: 2 } });
  assert.deepEqual(throwOf(1, 180), { throw: { vx: -1, vy: 0 } });
});

test('fields of a form that are empty or out of range give the nearest value', () => {
  assert.equal(within(undefined, 1, 3600), 1);
  assert.equal(within(NaN, 0, 5), 0);
  assert.equal(within(9, 0, 5), 5);
  assert.equal(within(2, 0, 5), 2);
});

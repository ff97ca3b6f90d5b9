// How far what was seen is from what the arena says.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { RobotSighting, State } from '../../../tools/console/src/lib/protocol';
import { offTruth } from '../../../tools/console/src/lib/truth';

const seen = (team: 'own' | 'opponent', id: number | null, x_m: number, y_m: number, heading_rad: number | null = 0): RobotSighting => ({ team, id, x_m, y_m, heading_rad, u_px: 0, v_px: 0, confidence: 1, outline_px: [] });
const state = (robots: RobotSighting[], truth?: State['truth'], ball: State['ball'] = null) => ({ robots, truth, ball }) as unknown as State;
const near = (value: number | null, expected: number) => assert.ok(value !== null && Math.abs(value - expected) < 1e-9, `${value} instead of ${expected}`);

test('a real field has no truth', () => {
  assert.equal(offTruth(null), null);
  assert.equal(offTruth(state([seen('own', 1, 0, 0)])), null);
});

test('distances, and headings across the jump at 180 degrees', () => {
  const truth: State['truth'] = { ball: { x_m: 0.1, y_m: 0.2 }, robots: [{ team: 'own', id: 1, x_m: 0, y_m: 0, heading_rad: Math.PI - 0.01 }, { team: 'own', id: 2, x_m: 0.5, y_m: 0, heading_rad: 0 }] };
  const off = offTruth(state([seen('own', 2, 0.5, 0.001), seen('own', 1, 0.003, 0, -Math.PI + 0.01)], truth, { x_m: 0.1, y_m: 0.1985, u_px: 0, v_px: 0, confidence: 1 }));
  assert.ok(off);
  near(off.ball_mm, 1.5);
  near(off.mean_mm, 2);
  near(off.max_mm, 3);
  near(off.max_deg, (180 / Math.PI) * 0.02);
  assert.deepEqual([off.robots, off.seen, off.missing], [2, 2, []]);
});

test('sightings without id count for the nearest robot of their team; a wrong id is far away', () => {
  const robots = [0, 1, 2].map((id) => ({ team: 'opponent' as const, id, x_m: 0.1 * id, y_m: 0, heading_rad: 0 }));
  const off = offTruth(state([seen('opponent', null, 0.101, 0, null), seen('opponent', null, 0.004, 0, null), seen('own', null, 0.2, 0)], { ball: { x_m: 0, y_m: 0 }, robots }));
  assert.ok(off);
  near(off.max_mm, 4);
  assert.equal(off.max_deg, null);
  assert.equal(off.ball_mm, null, 'not seen');
  assert.deepEqual(off.missing, [{ team: 'opponent', id: 2 }]);
  const wrong = offTruth(state([seen('opponent', 0, 0.2, 0)], { ball: { x_m: 0, y_m: 0 }, robots }));
  near(wrong!.max_mm, 200);
});

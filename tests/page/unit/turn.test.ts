// Whether a driven robot turns as it is told, or as in a mirror.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { TurnCheck, type TurnVerdict } from '../../../tools/console/src/lib/turn_check';

/** Drives for `seconds`; the robot is seen turning at `factor` of the command. */
function turned(check: TurnCheck, commanded: number, factor: number, seconds: number, from_s = 0): TurnVerdict {
  let verdict = check.verdict;
  for (let i = 0; i <= 30 * seconds; ++i) {
    const time = i / 30;
    // Headings jump from pi to -pi.
    const heading = Math.atan2(Math.sin(3 + factor * commanded * time), Math.cos(3 + factor * commanded * time));
    verdict = check.add(from_s + time, commanded, heading);
  }
  return verdict;
}

test('a robot that turns as commanded', () => {
  assert.equal(turned(new TurnCheck(), 3, 0.8, 2), 'same');
  assert.equal(turned(new TurnCheck(), -3, 0.8, 2), 'same');
});

test('a mirrored picture shows every turn the other way round', () => {
  assert.equal(turned(new TurnCheck(), 3, -0.8, 2), 'opposite');
  assert.equal(turned(new TurnCheck(), -3, -0.8, 2), 'opposite');
});

test('no verdict without a command, while the robot stands, or before the command can be seen', () => {
  assert.equal(turned(new TurnCheck(), 0, 1, 3), 'unknown');
  assert.equal(turned(new TurnCheck(), 3, 0, 3), 'unknown');
  assert.equal(turned(new TurnCheck(), 0.2, -20, 3), 'unknown');
  const check = new TurnCheck();
  assert.equal(turned(check, 6, -1, 0.3), 'unknown');
});

test('a later turn corrects the verdict', () => {
  const check = new TurnCheck();
  assert.equal(turned(check, 3, -1, 2), 'opposite');
  assert.equal(turned(check, 3, 1, 2, 10), 'same');
});

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { motionOfKeys, motionOfPad } from '../../../tools/console/src/lib/driving';
import { count, cssColor, duration, fixed } from '../../../tools/console/src/lib/format';
import { haltReasons, haltText } from '../../../tools/console/src/lib/halts';
import { sharedHistogram } from '../../../tools/console/src/lib/histogram';
import type { LatencySummary, State } from '../../../tools/console/src/lib/protocol';
import { reportName } from '../../../tools/console/src/lib/report';
import { STOP_WARNING_MS, StopRequest } from '../../../tools/console/src/lib/stop_request';
import { Trails } from '../../../tools/console/src/lib/trails';

const state = (number: number, halt: string[] = [], captured_s = number / 60): State => ({
  type: 'state', number, frame: number, captured_s, latency_ms: 11, ball: null, robots: [], commands: [], stop: halt.length > 0, halt,
  tracks: [{ team: 'own', id: 1, seen: true, x_m: number, y_m: 0, heading_rad: 0, speed_mps: 0, turn_radps: 0, sigma_x_m: 0, sigma_y_m: 0, covariance_xy_m2: 0, sigma_heading_rad: 0, action: { x_m: 0, y_m: 0, heading_rad: 0 }, confidence: 1 }],
});

test('only a newer state with the halt confirms a stop', () => {
  const stop = new StopRequest(10, 0);
  stop.accept(state(11, ['console']));
  assert.equal(stop.confirmed, false, 'it was not sent');
  stop.sent = true;
  stop.accept(state(10, ['console']));
  stop.accept(state(11));
  stop.accept(state(12, ['referee']));
  assert.equal(stop.confirmed, false);
  assert.equal(stop.isLate(STOP_WARNING_MS), false);
  assert.equal(stop.isLate(STOP_WARNING_MS + 1), true);
  stop.accept(state(13, ['referee', 'console']));
  assert.equal(stop.confirmed, true);
  assert.equal(stop.isLate(1e9), false);
});

test('after a restart of the board a stop is confirmed by its first states', () => {
  const stop = new StopRequest(50_000, 0);
  stop.restart();
  stop.accept(state(3, ['console']));
  assert.equal(stop.confirmed, false);
  stop.sent = true;
  stop.accept(state(4, ['console']));
  assert.equal(stop.confirmed, true);
});

test('without frames, only a status after the answer confirms a stop', () => {
  const stop = new StopRequest(10, 0);
  stop.passed(7);
  stop.acceptStatus(['console']);
  assert.equal(stop.confirmed, false, 'the board may not have heard it yet');
  stop.answered = true;
  stop.acceptStatus(null);
  stop.acceptStatus(undefined);
  stop.acceptStatus(['no_frames']);
  assert.equal(stop.confirmed, false);
  stop.acceptStatus(['no_frames', 'console']);
  assert.equal(stop.confirmed, true);
});

test('every halt has words, also one that this page does not know', () => {
  assert.equal(haltReasons(['emergency', 'no_frames']), 'the emergency stop is pulled, or was pulled, no picture from the camera');
  assert.equal(haltText('toString').reason, 'toString');
  assert.equal(haltText('meteor').reason, 'meteor');
  assert.equal(haltReasons(['setup', 'console'], true).split(',')[0], 'the board is not set up yet');
  assert.equal(haltReasons(['setup']), 'the board is being set up');
});

test('opposite keys cancel each other, and the pad has a dead zone', () => {
  assert.deepEqual(motionOfKeys(new Set(['KeyW', 'ArrowUp', 'KeyA'])), { forward: 1, left: 1 });
  assert.deepEqual(motionOfKeys(new Set(['KeyW', 'ArrowDown'])), { forward: 0, left: 0 });
  assert.deepEqual(motionOfKeys(new Set(['Enter'])), { forward: 0, left: 0 });
  assert.deepEqual(motionOfPad(0.05, 0.5), { forward: 0.5, left: -0 });
  assert.deepEqual(motionOfPad(-3, 2), { forward: 1, left: 1 });
});

test('trails keep three seconds of the board\'s clock, and begin again when it runs backwards', () => {
  const trails = new Trails();
  for (let number = 0; number <= 600; number += 1) trails.add(state(number));
  const [, points] = [...trails.entries()][0]!;
  assert.ok(points.length > 175 && points.length < 185, `${points.length} points`);
  trails.add(state(5));
  assert.equal([...trails.entries()][0]![1].length, 1);
});

test('both distributions share bins, and shares sum to 100 percent', () => {
  const summary = (bins: LatencySummary['bins']): LatencySummary => ({ count: bins.reduce((sum, bin) => sum + bin[2], 0), p50_ms: 0, p99_ms: 0, p999_ms: 0, max_ms: 0, bins });
  const shared = sharedHistogram(summary([[10, 10.3, 900], [10.3, 11, 99], [40, 41, 1]]), summary([[10, 10.3, 10]]));
  const sum = (values: (number | null)[]) => values.reduce<number>((total, value) => total + (value ?? 0), 0);
  assert.ok(Math.abs(sum(shared.start_percent) - 100) < 1e-9);
  assert.ok(Math.abs(sum(shared.minute_percent) - 100) < 1e-9);
  assert.ok(shared.edges_ms.length <= 41);
  assert.equal(shared.edges_ms[0], 10);
  assert.deepEqual(sharedHistogram(summary([]), summary([])).edges_ms, []);
});

test('numbers are formatted, and missing ones are dashes', () => {
  assert.equal(fixed(10.876, 1), '10.9');
  assert.equal(fixed(null, 1), '–');
  assert.equal(fixed(NaN, 1), '–');
  assert.equal(count(1234567), '1\u202f234\u202f567');
  assert.equal(duration(75), '1 min 15 s');
  assert.equal(duration(-1), '0 s');
  assert.equal(cssColor([1, 2, 3], 'none'), 'rgb(1 2 3)');
  assert.equal(cssColor(['red;}', 2, 3] as unknown as number[], 'none'), 'none');
});

test('names of files contain nothing that a file system reads', () => {
  assert.equal(reportName({ board: '../<b>' } as never, null), 'touchline--b--no-data.json');
});

// Frames and events of a recording, as the page reads them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { nextEvent, parseFrames, shownEvents, stepOf, type GameEvent } from '../../../tools/console/src/lib/recordings';

function bytesOf(frames: [number, number, string, number[]][]): ArrayBuffer {
  const parts = frames.map(([number, at, state, picture]) => {
    const text = new TextEncoder().encode(state);
    const head = new DataView(new ArrayBuffer(16));
    [number, at, text.length, picture.length].forEach((value, i) => head.setUint32(4 * i, value, true));
    return [...new Uint8Array(head.buffer), ...text, ...picture];
  });
  return new Uint8Array(parts.flat()).buffer;
}

test('frames have their state and picture, or neither', async () => {
  const data = bytesOf([[7, 1234, '{"number":7,"type":"state"}', [0xff, 0xd8, 1]], [8, 1400, '', []], [9, 1500, '{"number":', [1]]]);
  const [first, damaged, cut] = parseFrames(data);
  assert.equal(first!.number, 7);
  assert.equal(first!.at_ms, 123.4);
  assert.equal(first!.state!.number, 7);
  assert.deepEqual([...new Uint8Array(await first!.jpeg!.arrayBuffer())], [0xff, 0xd8, 1]);
  assert.deepEqual([damaged!.number, damaged!.state, damaged!.jpeg], [8, null, null]);
  assert.equal(cut!.state, null, 'no JSON');
  assert.equal(parseFrames(data.slice(0, data.byteLength - 1)).length, 2, 'an answer that was cut off');
  assert.deepEqual(parseFrames(new ArrayBuffer(0)), []);
});

const events: GameEvent[] = [
  { kind: 'score', frame: 0, at_s: 0 },
  { kind: 'slowest', frame: 3, at_s: 0.05 },
  { kind: 'goal', frame: 10, at_s: 0.2 },
  { kind: 'slowest', frame: 12, at_s: 0.25 },
  { kind: 'stop', frame: 20, at_s: 0.4 },
  { kind: 'goal', frame: 30, at_s: 0.6 },
];

test('a jump goes to the next event, and after the last one to the first', () => {
  assert.equal(nextEvent(events, ['goal'], 0)!.frame, 10);
  assert.equal(nextEvent(events, ['goal'], 10)!.frame, 30);
  assert.equal(nextEvent(events, ['goal'], 30)!.frame, 10);
  assert.equal(nextEvent(events, ['goal', 'stop'], 10)!.frame, 20);
  assert.equal(nextEvent(events, ['robot_lost'], 0), null);
});

test('only the slowest of all frames is shown, and no score', () => {
  assert.deepEqual(shownEvents(events).map(({ frame }) => frame), [10, 12, 20, 30]);
});

test('at most about thirty pictures a second are loaded', () => {
  assert.deepEqual([[60, 1], [60, 0.25], [60, 8], [25, 1], [240, 2]].map(([rate, speed]) => stepOf(rate!, speed!)), [2, 1, 16, 1, 16]);
});

import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';
import { Connection, RETRY_DELAYS_MS, SILENCE_MS } from '../../../tools/console/src/lib/connection';
import { BINARY_MAGIC, readMessage, readPictureHeader, type ServerMessage } from '../../../tools/console/src/lib/protocol';

class FakeSocket {
  readyState = 0;
  binaryType = '';
  sent: string[] = [];
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: ((event: { reason: string }) => void) | null = null;
  accept() {
    this.readyState = 1;
    this.onopen?.();
  }
  receive(data: unknown) {
    this.onmessage?.({ data });
  }
  fail(reason = '') {
    this.readyState = 3;
    this.onclose?.({ reason });
  }
  send(text: string) {
    this.sent.push(text);
  }
  close() {
    this.readyState = 3;
  }
}

// node 18 has no fake timers that later versions have, too.
const timers = {
  now: 0,
  waiting: new Map<number, { at: number; run: () => void }>(),
  next: 1,
  tick(ms: number) {
    this.now += ms;
    for (const [id, timer] of [...this.waiting]) {
      if (timer.at > this.now) continue;
      this.waiting.delete(id);
      timer.run();
    }
  },
};
globalThis.setTimeout = ((run: () => void, ms: number) => {
  timers.waiting.set(timers.next, { at: timers.now + ms, run });
  return timers.next++;
}) as unknown as typeof setTimeout;
globalThis.clearTimeout = ((id: number) => timers.waiting.delete(id)) as unknown as typeof clearTimeout;

let sockets: FakeSocket[];
let messages: ServerMessage[];
let losses: { reason: string; retryInMs: number }[];
let pictures: number[];
let connection: Connection;

beforeEach(() => {
  timers.waiting.clear();
  sockets = [];
  messages = [];
  losses = [];
  pictures = [];
  connection = new Connection(
    'ws://board/ws',
    {
      opened: () => undefined,
      lost: (reason, retryInMs) => losses.push({ reason, retryInMs }),
      message: (message) => messages.push(message),
      picture: (header) => pictures.push(header.number),
    },
    () => {
      const socket = new FakeSocket();
      sockets.push(socket);
      return socket as unknown as WebSocket;
    },
  );
  connection.open();
});

const latest = () => sockets.at(-1)!;
const hello = JSON.stringify({ type: 'hello', protocol: 1 });

test('attempts come at growing intervals, and a hello resets them', () => {
  for (const delay of [...RETRY_DELAYS_MS, RETRY_DELAYS_MS.at(-1)!]) {
    latest().fail('busy');
    assert.deepEqual(losses.at(-1), { reason: 'busy', retryInMs: delay });
    const before = sockets.length;
    timers.tick(delay - 1);
    assert.equal(sockets.length, before);
    timers.tick(1);
    assert.equal(sockets.length, before + 1);
  }
  latest().accept();
  latest().fail();
  // A server that accepts and closes at once is not asked more often.
  assert.equal(losses.at(-1)!.retryInMs, RETRY_DELAYS_MS.at(-1));
  timers.tick(RETRY_DELAYS_MS.at(-1)!);
  latest().accept();
  latest().receive(hello);
  latest().fail();
  assert.equal(losses.at(-1)!.retryInMs, RETRY_DELAYS_MS[0]);
});

test('a silent link counts as lost once, and its late events are ignored', () => {
  latest().accept();
  latest().receive(hello);
  const old = latest();
  timers.tick(SILENCE_MS - 1);
  assert.equal(losses.length, 0);
  old.receive(hello);
  timers.tick(SILENCE_MS - 1);
  assert.equal(losses.length, 0);
  timers.tick(1);
  assert.equal(losses.length, 1);
  old.fail();
  old.receive(hello);
  assert.equal(losses.length, 1);
  assert.equal(messages.length, 2);
  timers.tick(RETRY_DELAYS_MS[0]!);
  assert.equal(sockets.length, 2);
});

test('requests carry numbers; without a connection nothing is sent', () => {
  assert.equal(connection.send({ type: 'stop' }), 0);
  latest().accept();
  assert.equal(connection.send({ type: 'stop' }), 1);
  assert.equal(connection.send({ type: 'start' }), 2);
  assert.deepEqual(latest().sent.map((text) => JSON.parse(text)), [{ type: 'stop', request: 1 }, { type: 'start', request: 2 }]);
});

test('damaged messages are ignored', () => {
  latest().accept();
  for (const text of ['', '{', 'null', '7', '"state"', '[]']) latest().receive(text);
  assert.equal(messages.length, 0);
  assert.equal(readMessage('{"type":"event"}')?.type, 'event');
});

function picture(change: (view: DataView) => void = () => undefined): ArrayBuffer {
  const data = new ArrayBuffer(40);
  const view = new DataView(data);
  view.setUint32(0, BINARY_MAGIC, true);
  view.setUint8(4, 1);
  view.setUint8(5, 1);
  view.setUint16(6, 320, true);
  view.setUint16(8, 240, true);
  view.setUint16(10, 640, true);
  view.setBigUint64(16, 2n ** 40n + 7n, true);
  view.setBigInt64(24, 1_700_000_000_123_456n, true);
  change(view);
  return data;
}

test('the header of a picture is read, and damaged ones are refused', () => {
  assert.deepEqual(readPictureHeader(picture()), { width_px: 320, height_px: 240, full_width_px: 640, number: 2 ** 40 + 7, captured_s: 1_700_000_000.123456 });
  latest().accept();
  latest().receive(picture());
  assert.deepEqual(pictures, [2 ** 40 + 7]);
  assert.equal(readPictureHeader(picture().slice(0, 32)), null);
  assert.equal(readPictureHeader(picture((view) => view.setUint32(0, 7))), null);
  assert.equal(readPictureHeader(picture((view) => view.setUint8(4, 2))), null);
  assert.equal(readPictureHeader(picture((view) => view.setUint16(10, 0, true))), null);
});

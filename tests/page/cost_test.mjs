// What the console's clients cost the loop, in figures that do not depend on how busy the machine is: the system calls of its thread, as strace
// counts them. The program is TOUCHLINE_PROGRAM, its arena TOUCHLINE_BOARD.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { readFile, readdir } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';
import { startProgram } from './console_server.mjs';

const { WebSocket } = createRequire(new URL('../../tools/console/package.json', import.meta.url))('ws');

let server;
before(async () => (server = await startProgram(process.env.TOUCHLINE_PROGRAM, process.env.TOUCHLINE_BOARD)));
after(() => server?.end());

/** A client that wants everything. Returns the pictures that it has got. */
async function watch() {
  const socket = new WebSocket(`${server.url.replace('http', 'ws')}ws`, 'touchline.1');
  const got = { pictures: 0, close: () => socket.close() };
  await new Promise((resolve, reject) => socket.on('open', resolve).on('error', reject));
  socket.on('message', (data, isBinary) => {
    if (!isBinary) return;
    got.pictures += 1;
    socket.send(JSON.stringify({ type: 'seen', number: Number(data.readBigUInt64LE(16)) }));
  });
  socket.send(JSON.stringify({ type: 'watch', state_hz: 60, picture: { rate_hz: 60 }, findings: ['classes', 'regions', 'light'] }));
  return got;
}

const frames = async () => Number(/^touchline_frames_total (\d+)/m.exec(await (await fetch(`${server.url}metrics`)).text())[1]);

/** Calls of the loop, the program's main thread, by name and per frame, during some seconds. */
async function callsPerFrame() {
  const before_ = await frames();
  const table = await new Promise((resolve, reject) => {
    execFile('timeout', ['--signal=INT', '3', 'strace', '--summary-only', '--summary-columns=calls,name', '--attach', String(server.pid)], (error, _, text) =>
      /calls/.test(text) ? resolve(text) : reject(new Error(`strace: ${text}`)));
  });
  const count = (await frames()) - before_;
  assert.ok(count > 20, `${count} frames`);
  return Object.fromEntries([...table.matchAll(/^\s*(\d+) (\w+)\s*$/gm)].filter(([, , name]) => name !== 'total').map(([, calls, name]) => [name, Number(calls) / count]));
}

test('only the loop has real-time priority: the console waits for it', async (context) => {
  const other = await startProgram(process.env.TOUCHLINE_PROGRAM, process.env.TOUCHLINE_BOARD, 0, ['--set', 'realtime.priority=60']);
  try {
    const threads = await readdir(`/proc/${other.pid}/task`);
    // proc(5): the policy is field 41; 0: normal, 1: SCHED_FIFO. The name in brackets is field 2.
    const policy = async (thread) => Number((await readFile(`/proc/${other.pid}/task/${thread}/stat`, 'utf8')).split(') ')[1].split(' ')[38]);
    if ((await policy(other.pid)) !== 1) return context.skip('this user has no real-time priority');
    assert.ok(threads.length > 2);
    for (const thread of threads) assert.equal(await policy(thread), Number(thread) === other.pid ? 1 : 0, `thread ${thread}`);
  } finally {
    await other.end();
  }
});

test('four clients that get everything cause no system call of the loop, and it waits for no lock', async (context) => {
  const alone = await callsPerFrame().catch((error) => {
    if (!/not permitted/.test(error.message)) throw error;
    context.skip('strace may not watch another process here');
  });
  if (!alone) return;
  const clients = await Promise.all([watch(), watch(), watch(), watch()]);
  while (clients.some(({ pictures }) => pictures < 3)) await new Promise((done) => setTimeout(done, 100));
  const had = clients.map(({ pictures }) => pictures);
  const watched = await callsPerFrame();
  clients.forEach(({ pictures }, i) => assert.ok(pictures > had[i] + 3, 'the clients get pictures meanwhile'));
  clients.forEach(({ close }) => close());
  console.log(`calls per frame: ${JSON.stringify(alone)} without clients, ${JSON.stringify(watched)} with four`);
  assert.ok(alone.clock_nanosleep > 0.8, 'it waits for frames');
  assert.equal(watched.futex, undefined, 'a lock');
  assert.deepEqual(Object.keys(watched).sort(), Object.keys(alone).sort());
  for (const name of Object.keys(watched)) assert.ok(Math.abs(watched[name] - alone[name]) < 0.1, `${name}: ${alone[name]} and ${watched[name]} per frame`);
});

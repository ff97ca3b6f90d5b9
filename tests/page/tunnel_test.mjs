// The console through `ssh -L`, as docs/console.md says, with the real ssh and the server SSHD. The program is TOUCHLINE_PROGRAM, its arena TOUCHLINE_BOARD.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { createRequire } from 'node:module';
import { tmpdir, userInfo } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { startProgram } from './console_server.mjs';

const { WebSocket } = createRequire(new URL('../../tools/console/package.json', import.meta.url))('ws');
const { TOUCHLINE_PROGRAM: program, TOUCHLINE_BOARD: board, SSHD: sshd } = process.env;

let folder;
let server;
let tunnel;
let url; // of the laptop's end
before(async () => {
  folder = await mkdtemp(join(tmpdir(), 'touchline-tunnel-'));
  server = await startProgram(program, board);
  const port = await new Promise((resolve) => {
    const free = createServer().listen(0, '127.0.0.1', () => {
      const { port: found } = free.address();
      free.close(() => resolve(found));
    });
  });
  // The server is at the end of a pipe: nothing listens in the network.
  for (const key of ['host', 'user']) execFileSync('ssh-keygen', ['-q', '-t', 'ed25519', '-N', '', '-f', join(folder, key)]);
  if (process.getuid() === 0) await mkdir('/run/sshd', { recursive: true });
  await writeFile(join(folder, 'sshd_config'), `HostKey ${folder}/host\nAuthorizedKeysFile ${folder}/user.pub\nStrictModes no\nUsePAM no\nPidFile none\n`);
  await writeFile(
    join(folder, 'ssh_config'),
    `Host BOARD\n  ProxyCommand ${sshd} -i -f ${folder}/sshd_config -E ${folder}/sshd_log\n  User ${userInfo().username}\n  IdentityFile ${folder}/user\n` +
      `  IdentitiesOnly yes\n  UserKnownHostsFile ${folder}/known\n  StrictHostKeyChecking accept-new\n`,
  );
  tunnel = spawn('ssh', ['-F', join(folder, 'ssh_config'), '-N', '-L', `${port}:127.0.0.1:${server.port}`, 'BOARD'], { stdio: ['ignore', 'inherit', 'inherit'] });
  url = `http://127.0.0.1:${port}/`;
  for (let i = 0; ; i += 1) {
    const answered = await fetch(`${url}metrics`).then(({ ok }) => ok, () => false);
    if (answered) break;
    assert.ok(i < 300 && tunnel.exitCode === null, 'no tunnel');
    await new Promise((done) => setTimeout(done, 200));
  }
});
after(async () => {
  tunnel?.kill();
  await server?.end();
  if (folder) await rm(folder, { recursive: true, force: true });
});

test('the tunnel leads to the console: it needs no token, and a stop is confirmed', async () => {
  const socket = new WebSocket(`${url.replace('http', 'ws')}ws`, 'touchline.1', { origin: url.slice(0, -1) });
  const messages = [];
  let look = () => {};
  socket.on('message', (data, isBinary) => {
    messages.push(isBinary ? { type: 'picture' } : JSON.parse(data));
    look();
  });
  const until = (is) =>
    new Promise((resolve) => {
      look = () => messages.some(is) && resolve();
      look();
    });
  await new Promise((resolve, reject) => socket.on('open', resolve).on('error', reject));
  socket.send(JSON.stringify({ type: 'watch', state_hz: 15, picture: { rate_hz: 15, max_width_px: 640 } }));
  await until(({ type, halt }) => type === 'state' && halt.length === 0);
  await until(({ type }) => type === 'picture');
  socket.send(JSON.stringify({ type: 'stop', request: 1 }));
  await until(({ type, ok }) => type === 'answer' && ok);
  await until(({ type, halt }) => type === 'state' && halt.includes('console'));
  socket.close();
});

test('another site cannot use the tunnel', async () => {
  const socket = new WebSocket(`${url.replace('http', 'ws')}ws`, 'touchline.1', { origin: 'http://evil.example' });
  const refused = await new Promise((resolve) => socket.on('open', () => resolve('')).on('error', ({ message }) => resolve(message)));
  assert.match(refused, /403/);
});

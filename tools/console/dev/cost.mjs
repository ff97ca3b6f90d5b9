// Measures what the console costs: processor time and memory of `touchline run` with 0, 1 and 4 clients that watch everything at the full rate.
//   node tools/console/dev/cost.mjs PROGRAM BOARD [SECONDS]     after tools/console/build --install
// Processor time is that of the whole program with the arena, so that the difference to 0 clients counts. Use an idle computer.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { WebSocket } from 'ws';

const [program, board, seconds = '30'] = process.argv.slice(2);
if (!board || !(Number(seconds) >= 1)) {
  console.error('usage: node tools/console/dev/cost.mjs PROGRAM BOARD [SECONDS]');
  process.exit(64);
}
const wait = (s) => new Promise((done) => setTimeout(done, s * 1000));

const child = spawn(program, ['run', '--board', board, '--headless', '--pace', 'real', '--seed', '1', '--console', '127.0.0.1:0'], { stdio: ['ignore', 'pipe', 'inherit'] });
process.on('exit', () => child.kill('SIGKILL'));
const url = await new Promise((resolve, reject) => {
  createInterface(child.stdout).on('line', (line) => {
    const address = /http:\/\/(127\.0\.0\.1:\d+)/.exec(line);
    if (address) resolve(`ws://${address[1]}/ws`);
  });
  child.on('exit', () => reject(new Error(`${program} ended`)));
});

// proc(5): utime and stime in ticks of 10 ms, after the name in brackets.
const cpu_s = () => {
  const fields = readFileSync(`/proc/${child.pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / 100;
};
const memory_mb = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${child.pid}/status`, 'utf8'))[1]) * 1024 / 1e6;

let pictures = 0;
const clients = [];
async function addClient() {
  const socket = new WebSocket(url, ['touchline.1']);
  clients.push(socket);
  await new Promise((done, fail) => socket.on('open', done).on('error', fail));
  socket.on('message', (data, isBinary) => {
    if (!isBinary) return;
    pictures += 1;
    socket.send(JSON.stringify({ type: 'seen', number: Number(data.readBigUInt64LE(16)) }));
  });
  socket.send(JSON.stringify({ type: 'watch', state_hz: 60, picture: { rate_hz: 60 } }));
}

for (const count of [0, 1, 4]) {
  while (clients.length < count) await addClient();
  await wait(2);
  const [begin_s, begin, before] = [cpu_s(), performance.now(), pictures];
  await wait(Number(seconds));
  const elapsed_s = (performance.now() - begin) / 1000;
  console.log(`${count} clients: ${((cpu_s() - begin_s) / elapsed_s).toFixed(4)} CPU s per second, ${memory_mb().toFixed(1)} MB, ${((pictures - before) / elapsed_s).toFixed(1)} pictures per second`);
}
process.exit(0);

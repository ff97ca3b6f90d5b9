// A server with a simulated game, to develop the page without a build of Touchline and to show what a real server shows
// rarely: node dev/server.js [--port N] [--protocol N] [--hello JSON of `hello`] [--setup false] [--camera false]. It serves dist/ and speaks
// docs/console-protocol.md.
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { WebSocketServer } from 'ws';
import { devices, ports } from './devices.js';
import { Game } from './game.js';
import { makePicture } from './picture.js';
import { Setup } from './setup.js';
import { version } from './version.js';

const { values } = parseArgs({
  options: { port: { type: 'string', default: '8642' }, protocol: { type: 'string', default: '1' }, version: { type: 'string', default: version }, hello: { type: 'string', default: '{}' }, setup: { type: 'string', default: 'true' }, camera: { type: 'string', default: 'true' } },
});
const recording = { bytes: 1674.2e6, growing: false, complete: true, date: '', duration_s: 612.4, frames: 36744, goals: 3, stops: 7, lost: 2, score: { own: 2, opponent: 1, by: 'referee' }, problem: '' };
const recordings = [
  { ...recording, name: 'touchline-0044-20261128-173005.mcap', date: '2026-11-28 17:30:05', growing: true, complete: false },
  { ...recording, name: 'touchline-0043.mcap', complete: false, score: { own: 0, opponent: 1, by: 'rule' } },
  { ...recording, name: 'touchline-0042.mcap', problem: '/var/lib/touchline/recordings/touchline-0042.mcap: is not a recording (MCAP)', frames: 0, score: null },
  { ...recording, name: 'final against the neighbors.mcap' },
];
const dist = fileURLToPath(new URL('../dist/', import.meta.url));
const game = new Game();
// Without a camera there are no pictures until somebody chooses one.
if (values.camera === 'false') game.lost = [{ device: 'camera', reason: '/dev/video0: no such device' }];
const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };

const server = createServer((request, response) => {
  const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
  if (path === '/devices' || path === '/ports') {
    response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify(path === '/ports' ? ports : devices(game)));
    return;
  }
  if (path === '/recordings') {
    response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify({ folder: '/var/lib/touchline/recordings', recordings }));
    return;
  }
  const file = join(dist, path === '/' ? 'index.html' : path);
  if (!file.startsWith(dist) || !existsSync(file)) {
    response.writeHead(404).end('not found');
    return;
  }
  response.writeHead(200, {
    'Content-Type': types[extname(file)] ?? 'application/octet-stream',
    'Content-Security-Policy': "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; connect-src 'self'; frame-ancestors 'none'",
  });
  createReadStream(file).pipe(response);
});

const clients = new Map();
let nextClient = 1;
let driver = null;
const tellDriver = () => {
  for (const [socket, client] of clients) send(socket, { type: 'driver', driver, you: driver === client.number });
};
const send = (socket, message) => socket.send(JSON.stringify(message));
const setupRuns = values.setup === 'true';
const watchers = () => [...clients].filter(([, client]) => client.setup).map(([socket]) => socket);
const setup = new Setup(
  game,
  (message) => watchers().forEach((socket) => send(socket, message)),
  (id, content) => watchers().forEach((socket) => socket.send(setupPicture(id, content))),
);

function setupPicture(id, content) {
  const header = Buffer.alloc(32);
  header.writeUInt32LE(0x43504c54, 0);
  header.writeUInt8(1, 4);
  header.writeUInt8(2, 5);
  header.writeUInt32LE(id, 12);
  return Buffer.concat([header, content]);
}

async function runSetup(socket, client, message) {
  const answer = { type: 'answer', to: message.request };
  try {
    if (!setupRuns) throw new Error('the setup program is not running: systemctl start touchline-setup');
    if (driver !== client.number) throw new Error('another screen has control');
    send(socket, { ...answer, ok: true, result: await setup.run(message) });
  } catch (error) {
    send(socket, { ...answer, ok: false, error: error.message });
  }
}
const sockets = new WebSocketServer({ server, path: '/ws' });

sockets.on('connection', (socket) => {
  if (socket.protocol === 'touchline.stop.1') {
    socket.on('message', (data) => {
      const message = JSON.parse(data.toString());
      if (message.type === 'stop') game.stop(0);
      if (message.request) send(socket, { type: 'answer', to: message.request, ok: true });
    });
    return;
  }
  const client = { number: nextClient++, picture: null, state_hz: 15, waiting: 0, nextState: 0, nextPicture: 0 };
  clients.set(socket, client);
  send(socket, { ...game.hello(), protocol: Number(values.protocol), version: values.version, you: client.number, setup: setupRuns, stop_line: true, ...JSON.parse(values.hello) });
  for (const event of game.events) send(socket, event);
  tellDriver();
  socket.on('close', () => {
    clients.delete(socket);
    if (driver === client.number) {
      driver = null;
      game.stop(client.number);
      tellDriver();
    }
  });
  socket.on('message', (data) => {
    const message = JSON.parse(data.toString());
    let error;
    if (message.type === 'setup') {
      void runSetup(socket, client, message);
      return;
    }
    if (message.type === 'watch') {
      if (message.setup && !client.setup && setupRuns) {
        for (const [id, content] of setup.pictures) socket.send(setupPicture(id, content));
        send(socket, setup.state());
      }
      Object.assign(client, { picture: message.picture, state_hz: message.state_hz, setup: message.setup });
    }
    else if (message.type === 'seen') client.waiting = Math.max(0, client.waiting - 1);
    else if (message.type === 'stop') game.stop(client.number);
    else if (message.type === 'take') driver = client.number;
    else if (message.type === 'release' && driver === client.number) driver = null;
    else if (['start', 'drive', 'adaptation'].includes(message.type)) {
      if (driver !== client.number) error = 'another screen has control';
      else if (message.type === 'adaptation') game.adaptation = { freeze: 'frozen', follow: 'follow', reset: 'off' }[message.action];
      else if (message.type === 'start') error = game.start(message.stop_number);
      else if (message.give_back) game.driven = null;
      else game.drive(message.id, message.speed_mps, message.turn_radps);
    }
    if (message.request) send(socket, { type: 'answer', to: message.request, ok: !error, error });
    if (message.type === 'take' || message.type === 'release') tellDriver();
  });
});

let picture = { number: -1, jpeg: null };
const frameMs = 1000 / 60;
setInterval(() => {
  game.step(frameMs / 1000);
  const now = performance.now();
  for (const [socket, client] of clients) {
    const pictureDue = client.picture && !game.lost.length && client.waiting < 2 && now >= client.nextPicture;
    if (now < client.nextState && !pictureDue) continue;
    client.nextState = now + 1000 / client.state_hz;
    send(socket, game.state());
    if (!pictureDue) continue;
    if (picture.number !== game.number) picture = { number: game.number, jpeg: makePicture(game) };
    client.nextPicture = now + 1000 / client.picture.rate_hz;
    client.waiting += 1;
    socket.send(picture.jpeg);
  }
}, frameMs);
setInterval(() => {
  for (const socket of clients.keys()) send(socket, game.status(clients.size));
}, 1000);

server.listen(Number(values.port), '127.0.0.1', () => console.log(`console: http://127.0.0.1:${server.address().port}/`));

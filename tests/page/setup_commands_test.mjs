// The setup's commands with the real programs, without the page: what a browser would be too slow to show.
import assert from 'node:assert/strict';
import { cp, mkdtemp, readFile, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { startProgram, startSetup } from './console_server.mjs';

const { WebSocket } = createRequire(new URL('../../tools/console/package.json', import.meta.url))('ws');
const { TOUCHLINE_PROGRAM: program, TOUCHLINE_SETUP: setupProgram, TOUCHLINE_BOARD: original } = process.env;

/** The driver of a console. */
class Driver {
  static async connect(url) {
    const driver = new Driver();
    driver.socket = new WebSocket(`${url.replace('http', 'ws')}ws`, 'touchline.1');
    driver.socket.on('message', (data, isBinary) => isBinary || driver.accept(JSON.parse(data)));
    await new Promise((resolve, reject) => driver.socket.on('open', resolve).on('error', reject));
    driver.ping = setInterval(() => driver.send({ type: 'ping' }), 300);
    driver.send({ type: 'watch', picture: null, state_hz: 30, setup: true });
    await driver.until('setup', () => true);
    await driver.ask({ type: 'take' });
    return driver;
  }
  newest = {};
  hellos = [];
  waiting = new Set();
  answers = new Map();
  request = 0;

  send(message) {
    this.socket.send(JSON.stringify(message));
  }
  accept(message) {
    this.newest[message.type] = message;
    if (message.type === 'hello') this.hellos.push(message);
    if (message.type === 'answer') this.answers.get(message.to)?.(message);
    for (const check of this.waiting) check();
  }
  /** Waits for a message of this type, also one that has arrived already. */
  until(type, is) {
    return new Promise((resolve) => {
      const check = () => {
        if (!this.newest[type] || !is(this.newest[type])) return;
        this.waiting.delete(check);
        resolve(this.newest[type]);
      };
      this.waiting.add(check);
      check();
    });
  }
  async ask(message) {
    const request = ++this.request;
    const answered = new Promise((resolve) => this.answers.set(request, resolve));
    this.send({ ...message, request });
    const answer = await answered;
    assert.ok(answer.ok, `${message.command ?? message.type}: ${answer.error}`);
    return answer.result;
  }
  setup(command, members = {}) {
    return this.ask({ type: 'setup', command, ...members });
  }
  /** Begins a draft and waits until the firmware runs with it. */
  async begin() {
    await this.setup('begin');
    await this.until('hello', ({ using }) => using === 'draft');
    await this.until('setup', ({ state }) => state.preview.source === 'draft' && state.preview.ok);
  }
  close() {
    clearInterval(this.ping);
    this.socket.close();
  }
}

async function withArena(files, run) {
  const folder = await mkdtemp(join(tmpdir(), 'touchline-commands-'));
  let setup;
  let server;
  let driver;
  try {
    for (const name of files) await cp(join(dirname(original), name), join(folder, name));
    const board = join(folder, 'board.toml');
    const socket = join(folder, 'setup.sock');
    setup = await startSetup(setupProgram, board, join(folder, 'state'), socket);
    server = await startProgram(program, board, 0, ['--set', `console.setup_socket=${socket}`]);
    driver = await Driver.connect(server.url);
    await run(driver, folder);
  } finally {
    driver?.close();
    await server?.end();
    await setup?.end();
    await rm(folder, { recursive: true, force: true });
  }
}

test('a bare board without a venue file starts, and its exposure changes without a restart of the session', () =>
  withArena(['board.toml', 'team.toml'], async (driver) => {
    assert.equal(driver.newest.hello.calibrated, false);
    await driver.begin();
    const bright = (await driver.setup('camera.quality')).mean[1];
    const hellos = driver.hellos.length;
    const { number } = await driver.until('state', () => true);
    const begin = performance.now();
    for (const value of [4000, 3000, 2000, 1000]) await driver.setup('set', { key: 'camera.exposure_us', value, continues: true });
    let dark = bright;
    while (dark > 0.6 * bright) dark = (await driver.setup('camera.quality')).mean[1];
    console.log(`mean ${bright} to ${dark} in ${(performance.now() - begin).toFixed(0)} ms`);
    assert.equal(driver.hellos.length, hellos, 'the session went on');
    assert.deepEqual(driver.newest.setup.state.undo, ['camera.exposure_us 1000']);
    await driver.setup('undo');
    while (dark < 0.9 * bright) dark = (await driver.setup('camera.quality')).mean[1];
    assert.equal(driver.hellos.length, hellos);
    // Another key needs a new session; its frames are numbered on.
    await driver.setup('set', { key: 'camera.buffers', value: 6 });
    await driver.until('hello', () => driver.hellos.length > hellos);
    assert.ok((await driver.until('state', (state) => state.number > number)).number > number);
  }));

test('an exported setup is imported into a bare board, tried, and saved', () =>
  withArena(['board.toml', 'team.toml', 'venue.toml', 'venue-light.png', 'venue-field.png'], async (calibrated) => {
    await calibrated.begin();
    const { text } = await calibrated.setup('export');
    await withArena(['board.toml', 'team.toml'], async (driver, folder) => {
      await driver.begin();
      const piece = 3000;
      const parts = Math.ceil(text.length / piece);
      for (let part = 0; part < parts; ++part) await driver.setup('import', { part, parts, text: text.slice(part * piece, (part + 1) * piece) });
      await driver.until('hello', (hello) => hello.calibrated && hello.using === 'draft');
      const moves = (state) => state.tracks.some((track) => track.team === 'own' && track.speed_mps > 0.2);
      await driver.until('state', (state) => state.halt.includes('setup'));
      await driver.setup('try', { on: true });
      await driver.until('state', (state) => state.halt.length === 0 && moves(state));
      await driver.ask({ type: 'stop' });
      await driver.until('state', (state) => state.stop && !moves(state));
      await driver.until('setup', ({ state }) => state.open);
      await driver.setup('save');
      assert.match(await readFile(join(folder, 'venue.toml'), 'utf8'), /camera_model/);
      await driver.until('hello', (hello) => hello.calibrated && hello.using === 'saved');
    });
  }));

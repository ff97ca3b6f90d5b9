// The setup of a copy of the arena TOUCHLINE_BOARD, with the real programs TOUCHLINE_PROGRAM and TOUCHLINE_SETUP.
import assert from 'node:assert/strict';
import { createSocket } from 'node:dgram';
import { on, once } from 'node:events';
import { cp, mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { hold, launch, open, show, waitForHalt, waitForPicture } from './browser.mjs';
import { startProgram, startSetup } from './console_server.mjs';
import { act, begin, next } from './setup_steps.mjs';

const { WebSocket } = createRequire(new URL('../../tools/console/package.json', import.meta.url))('ws');
const { TOUCHLINE_PROGRAM: program, TOUCHLINE_SETUP: setupProgram, TOUCHLINE_BOARD: original } = process.env;

let browser;
before(async () => (browser = await launch()));
after(async () => browser?.close());

// Robot 1 of the arena with seed 1 and arena.physics.wheel_error = 0.15.
const GAINS = [0.9977, 0.907];
const CALIBRATED = /^\[+(camera_model|light|colors|color|noise)\b/;

/** A venue file without the sections that calibration writes. */
function uncalibrated(text) {
  let keep = true;
  return text
    .split('\n')
    .filter((line) => {
      if (line.startsWith('[')) keep = !CALIBRATED.test(line);
      return keep;
    })
    .join('\n');
}

/**
 * Until the ball is seen behind a goal line, and soon after in the center of the field: a ball on the line is no goal yet.
 * A ball that lies still for longer also returns to the center.
 */
async function waitForGoal(server) {
  const socket = new WebSocket(`${server.url.replace('http', 'ws')}ws`, 'touchline.1');
  const SOON_S = 1.5, KICK_OFF_M = 0.1;
  // Games of the arena have a goal in less than half a minute. Without a limit the test would wait for robots that stand.
  const limit = setTimeout(() => socket.close(), 300_000);
  let field;
  let crossedAt = -Infinity;
  let wasBehind = false;
  try {
    for await (const [data, isBinary] of on(socket, 'message', { close: ['close'] })) {
      if (isBinary) continue;
      const message = JSON.parse(data);
      if (message.type === 'hello') {
        field = message.field;
        socket.send(JSON.stringify({ type: 'watch', picture: null, state_hz: 60 }));
      }
      const { ball, captured_s } = message.type === 'state' ? message : {};
      if (!ball) continue;
      const isBehind = Math.abs(ball.x_m) > field.length_m / 2 && Math.abs(ball.y_m) < field.goal_width_m / 2;
      if (isBehind && !wasBehind) crossedAt = captured_s;
      wasBehind = isBehind;
      if (Math.hypot(ball.x_m, ball.y_m) < KICK_OFF_M && captured_s - crossedAt < SOON_S) return;
    }
    assert.fail('no goal in five minutes');
  } finally {
    clearTimeout(limit);
    socket.close();
  }
}

/** Until robots may move and nobody has control: a page with control that gets no processor for a second stops the robots. */
async function startToPlay(page) {
  for (let attempt = 1; ; attempt += 1) {
    try {
      const take = page.locator('button:text-matches("^Take (control|over)$")');
      if (await take.count()) await take.click({ timeout: 15_000 });
      await page.click('[data-start]:not([disabled])', { timeout: 15_000 });
      await waitForHalt(page, false, 15_000);
      await page.click('button:text-is("Give up control")', { timeout: 15_000 });
      await page.waitForSelector('text=Nobody has control.', { timeout: 15_000 });
      return await waitForHalt(page, false, 5000);
    } catch (error) {
      if (attempt === 4) throw error;
    }
  }
}

/** Takes hold of the arena's ball with the crosshair, and puts it down 30 pixels above and on the left, off the lines. */
async function moveTheBallByKeyboard(page) {
  const cross = async () => (await page.getAttribute('canvas[data-picture]', 'data-cross')).split(' ').map(Number);
  const place = () => page.evaluate(() => {
    const canvas = document.querySelector('canvas[data-picture]');
    const { data, width } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let [count, u, v] = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4) {
      if (data[i] < 170 || data[i] - data[i + 1] < 80 || data[i + 1] - data[i + 2] < 40) continue; // orange alone
      [count, u, v] = [count + 1, u + ((i / 4) % width), v + Math.floor(i / 4 / width)];
    }
    const scale = Math.min(canvas.width / 640, canvas.height / 480);
    return [319.5 + (u / count - canvas.width / 2) / scale, 239.5 + (v / count - canvas.height / 2) / scale];
  });
  const go = async ([u, v]) => {
    for (const [axis, keys, wanted] of [[0, ['ArrowLeft', 'ArrowRight'], u], [1, ['ArrowUp', 'ArrowDown'], v]]) {
      for (let presses = 0; presses < 200; presses += 1) {
        const off = wanted - (await cross())[axis];
        if (Math.abs(off) < 4) break;
        await page.keyboard.press(`${Math.abs(off) > 40 ? 'Shift+' : ''}${keys[off > 0 ? 1 : 0]}`);
      }
    }
  };
  await page.click('[data-move-objects]');
  await waitForPicture(page);
  let from = await place();
  while (!Number.isFinite(from[0])) from = await place(); // the canvas is not drawn yet
  await page.focus('canvas[data-picture]');
  await page.keyboard.press('ArrowDown'); // it appears
  await go(from);
  await page.keyboard.press('Enter');
  await page.waitForSelector('canvas[data-moving="true"]');
  await go([from[0] - 30, from[1] - 30]);
  await page.keyboard.press('Enter');
  await page.waitForSelector('canvas[data-moving=""]');
  await page.keyboard.press('Escape');
  for (let attempt = 0; ; attempt += 1) {
    await page.waitForTimeout(200);
    const to = await place();
    if (Math.hypot(to[0] - from[0] + 30, to[1] - from[1] + 30) < 10) break;
    assert.ok(attempt < 50, `the ball is at ${to}, it was at ${from}`);
  }
  await page.click('[data-move-objects]');
}

/** Both programs with a copy of the board's folder; `change` of its venue file. */
async function withArena(run, change = (text) => text, settings = [], options = []) {
  const folder = await mkdtemp(join(tmpdir(), 'touchline-arena-'));
  let setup;
  let server;
  try {
    for (const name of await readdir(dirname(original))) if (/\.(toml|png)$/.test(name)) await cp(join(dirname(original), name), join(folder, name));
    const venue = join(folder, 'venue.toml');
    await writeFile(venue, change(await readFile(venue, 'utf8')));
    const board = join(folder, basename(original));
    const socket = join(folder, 'setup.sock');
    setup = await startSetup(setupProgram, board, join(folder, 'state'), socket);
    server = await startProgram(program, board, 0, ['--set', `console.setup_socket=${socket}`, '--set', 'arena.opponents=stand', ...settings.flatMap((one) => ['--set', one]), ...options]);
    const { page, problems, close } = await open(browser, `${server.url}#setup`);
    await run(page, folder, server);
    assert.deepEqual(problems, []);
    await close();
  } finally {
    await server?.end();
    await setup?.end();
    await rm(folder, { recursive: true, force: true });
  }
}

test('the field is found, undone with one key, and saved after its difference was shown', () =>
  withArena(async (page, folder) => {
    const venue = () => readFile(join(folder, 'venue.toml'), 'utf8');
    const before = await venue();
    await begin(page);
    await page.click('[data-goto="field"]');
    await page.selectOption('[data-preset]:not([disabled])', 'mirosot-middle');
    await page.fill('[data-height]', '2.3');
    await page.click('[data-action="field"]:not([disabled])');
    await page.waitForSelector('[data-error-map]');
    await page.waitForSelector('[data-quality="ok"]:has-text("mm")');
    await page.focus('#main');
    await page.keyboard.press('Control+z');
    await page.waitForSelector('[data-undo="0"]');
    await page.waitForSelector('[data-error-map]', { state: 'detached' });
    await page.keyboard.press('Control+y');
    await page.waitForSelector('[data-error-map]');

    await page.click('[data-save]');
    await page.waitForSelector('[data-save-panel] .added:has-text("fx_px")');
    assert.equal(await venue(), before, 'nothing is written before the differences were shown');
    await page.click('[data-confirm-save]:not([disabled])');
    await page.waitForSelector('[data-message]:has-text("Saved")');
    const after = await venue();
    assert.ok(after !== before && after.includes('line_width_m') && after.includes('[camera_model.full]'));
    assert.equal(await readFile(join(folder, 'venue.toml.bak'), 'utf8'), before);
    await page.waitForSelector('[data-begin]');
  }));

/** A port of this computer that nobody uses. */
async function freePort() {
  const socket = createSocket('udp4');
  await once(socket.bind(0, '127.0.0.1'), 'listening');
  const { port } = socket.address();
  await new Promise((done) => socket.close(done));
  return port;
}

/** Sends a request to the arena, as docs/arena.md describes. */
async function ask(port, request) {
  const socket = createSocket('udp4');
  await new Promise((done, fail) => socket.send(JSON.stringify(request), port, '127.0.0.1', (error) => (error ? fail(error) : done())));
  socket.close();
}

// Robot 1 has room around it, wherever the play before has left the others, and also when a ball that rests is put back to the center.
const PLACES = {
  ball: { x: 0, y: 0 },
  robots: { blue: { 0: { x: -1, y: 0 }, 1: { x: 0.05, y: -0.45 }, 2: { x: -0.55, y: -0.45 }, 3: { x: -0.3, y: 0.3 }, 4: { x: -0.75, y: 0 } } },
};

/**
 * Runs a test of robot 1, from a place with room around it. A page that gets no processor for a second loses the robot, and rightly so; it is
 * then run anew.
 */
async function testRobot(page, port, press, shown) {
  for (let attempt = 1; ; attempt += 1) {
    await ask(port, { place: PLACES });
    await press();
    await page.waitForSelector(`${shown}, [data-setup-error]`);
    const error = page.locator('[data-setup-error]');
    if (!(await error.count())) return;
    const text = await error.innerText();
    if (attempt === 3 || !/stands|stand:/.test(text)) throw new Error(text);
    await error.locator('button').click();
    await page.click('[data-release-stop]:not([disabled])');
    await page.waitForSelector('[data-halt="setup"]');
  }
}

test('a robot is tried with its wheels in the air, measured, and its values are written', async () => {
  const port = await freePort();
  await withArena(
    async (page, folder, server) => {
      await begin(page);
      await page.click('[data-goto="radio"]');
      await page.waitForSelector('[data-pattern="turn"][disabled]');
      await page.click('[data-robot="1"]:not([disabled])');
      await page.waitForSelector('[data-measure-drive]:not([disabled])');
      await page.waitForSelector('[data-pattern="turn"][disabled]');
      await page.check('[data-lifted]');
      await testRobot(page, port, () => page.click('[data-pattern="turn"]:not([disabled])'), '[data-sent]:has-text("left of robot 1: -200 = -0.200 m/s")');
      await page.waitForSelector('[data-test-text]:has-text("the robot would turn to the left")');
      assert.match(await page.innerText('[data-sent]'), /right of robot 1: 200 = 0.200 m\/s/);
      await page.waitForSelector('[data-test-stop]', { state: 'detached' });
      assert.match(await page.innerText('[data-exchange]'), /^\d{2,} packets sent/);
      await page.waitForSelector('[data-received]:has-text("battery")');

      // A stop ends the test, and a start does not resume it.
      await page.click('[data-pattern="turn"]:not([disabled])');
      await page.waitForSelector('[data-test-stop]');
      await page.keyboard.press('Space');
      await page.waitForSelector('[data-setup-error]:has-text("robots were stopped")');
      await page.click('[data-setup-error] button');
      await page.click('[data-release-stop]:not([disabled])');
      await page.waitForSelector('[data-halt="setup"]');
      // Another step ends it, too.
      await page.click('[data-pattern="turn"]:not([disabled])');
      await page.waitForSelector('[data-test-stop]');
      await page.click('[data-goto="robots"]');
      await page.waitForSelector('[data-action="robots"]:not([disabled])');
      await page.click('[data-goto="radio"]');

      if (!(await page.locator('[data-robot="1"][aria-pressed="true"]').count())) await page.click('[data-robot="1"]:not([disabled])');
      await testRobot(page, port, () => page.click('[data-measure-drive]:not([disabled])'), '[data-drive-result]');
      assert.match(await page.innerText('[data-wiring]'), /^Robot 1, wiring: right/);
      const key = 'own.robot[1].wheel_gain';
      await page.click(`[data-write="${key}"]:not([disabled])`);
      await page.waitForSelector(`[data-written="${key}"]`);
      await page.waitForSelector('[data-write="radio.delay_s"]');
      await page.focus('#main');
      await page.keyboard.press('Control+z');
      await page.waitForSelector(`[data-write="${key}"]:not([disabled])`);
      await page.click(`[data-write="${key}"]:not([disabled])`);
      await page.waitForSelector(`[data-written="${key}"]`);
      await page.click('[data-save]');
      await page.click('[data-confirm-save]:not([disabled])');
      await page.waitForSelector('[data-message]:has-text("Saved")');
      const [, left, right] = /wheel_gain = \[([\d.]+), ([\d.]+)\]/.exec(await readFile(join(folder, 'team.toml'), 'utf8'));
      // On a busy machine, pictures are missing; tests/tools/drive_measurement_test.cpp has the bounds of a machine that is not.
      assert.ok(Math.abs(left - GAINS[0]) < 0.02 && Math.abs(right - GAINS[1]) < 0.02, `${left}, ${right}`);
    },
    (text) => text,
    ['arena.physics.wheel_error=0.15', 'arena.radio.delay_s=0.05'],
    ['--accept', `json=udp://127.0.0.1:${port}`],
  );
});

test('from an arena without calibration to a scored goal', () =>
  withArena(async (page, folder, server) => {
    const venue = () => readFile(join(folder, 'venue.toml'), 'utf8');
    const before = await venue();
    assert.ok(!before.includes('camera_model') && !before.includes('[[color]]'));

    await show(page, 'play');
    await page.waitForSelector('[data-reasons]:has-text("the board is not set up yet")');
    await show(page, 'live');
    await page.click('[data-bare] a');
    await begin(page);
    await page.waitForSelector('[data-halt="setup"]:has-text("is being set up")');
    await waitForPicture(page);
    await page.waitForSelector('[data-live="true"]');
    // Every advice is taken, and gone then.
    const advice = await page.locator('[data-step="camera"] [data-quality="warning"]').textContent();
    const exposure = page.locator('.key:has(label:has-text("Exposure")) input[type="number"]:not([disabled])');
    await exposure.fill(/expose at most (\d+) us/.exec(advice)[1]);
    await exposure.press('Tab');
    await page.waitForSelector('[data-step="camera"] [data-quality="ok"]');
    // As bright as before, as docs/console.md says: in a dark picture orange and brown are close to each other.
    const gain = page.locator('.key:has(label:has-text("Gain")) input[type="number"]:not([disabled])');
    await gain.fill('220');
    await gain.press('Tab');
    await act(page, 'camera');
    await next(page, 'field');
    await page.selectOption('[data-preset]:not([disabled])', 'mirosot-middle');
    await act(page, 'field');
    await page.waitForSelector('.notes .warning:has-text("the height of the lens was not measured")');
    const seen = /says ([\d.]+) m/.exec(await page.textContent('[data-seen-height]'))[1];
    await page.fill('[data-height]', seen);
    await page.click('[data-action="field"]:not([disabled])');
    await page.waitForSelector('.notes .warning', { state: 'detached' });
    await next(page, 'light');
    await page.click('[data-goto="field"]');
    assert.equal(Number(await page.inputValue('[data-height]')), Number(seen), 'what was entered stays');
    await next(page, 'light');
    await act(page, 'light');
    await page.waitForSelector('[data-after]');
    await next(page, 'robots');
    await page.waitForSelector('[data-top="own-4"]');
    await page.waitForSelector('[data-quality="none"]'); // no tick before a person has compared them
    await page.fill('[data-ball-radius]:not([disabled])', '21.35');
    await act(page, 'robots');
    await next(page, 'colors');
    await moveTheBallByKeyboard(page);
    await act(page, 'colors'); // without a click
    await page.waitForSelector('[data-color-chip="orange"]:not(.missing)');
    assert.match(await page.innerText('[data-step="colors"]'), /good: 10 of 10 robots recognized/);
    await page.click('[data-noise]:not([disabled])');
    await page.waitForSelector('[data-noise-result]');
    await next(page, 'radio');
    await page.click('[data-robot="2"]:not([disabled])');
    await hold(page, () => page.keyboard.down('KeyW'), () => page.keyboard.up('KeyW'), '[data-driving]:text-matches("^0.[1-9]")');
    await page.keyboard.up('KeyW');
    await act(page, 'radio');
    await next(page);

    await page.waitForSelector('[data-save-panel] .added:has-text("[camera_model]")');
    assert.equal(await venue(), before, 'nothing is written before the differences were shown');
    await page.click('[data-try]:not([disabled])');
    await page.waitForSelector('[data-try][aria-pressed="true"]');
    await page.waitForSelector('[data-halt=""]:has-text("Robots may move")');
    await page.keyboard.press('Space');
    await page.waitForSelector('[data-halt~="console"]');
    await page.waitForSelector('[data-try][aria-pressed="false"][disabled]');
    await page.click('[data-release-stop]:not([disabled])');
    await page.waitForSelector('[data-halt="setup"]');
    await page.waitForSelector('[data-try]:not([disabled])');
    await page.click('[data-confirm-save]:not([disabled])');
    await page.waitForSelector('[data-message]:has-text("Saved")');
    const after = await venue();
    assert.ok(after.includes('[camera_model') && after.includes('[[color]]') && after.includes('[noise]'));
    assert.match(after, /penalty_area_depth_m = 0/, 'the arena has no penalty areas');

    await page.click('[data-to-play]');
    await startToPlay(page);
    await waitForGoal(server);
    await page.close();
    await server.end();
    assert.match(server.output(), /goals ([1-9]\d* : \d+|\d+ : [1-9])/);
  }, uncalibrated));

// The arena's controls of the page Live with the real program, TOUCHLINE_PROGRAM, and its arena, TOUCHLINE_BOARD; and that a board with real
// devices has none of them.
import assert from 'node:assert/strict';
import { on } from 'node:events';
import { cp, mkdtemp, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { PATIENCE_MS, axe, launch, open, show, waitForLink, waitForPicture } from './browser.mjs';
import { start, startProgram } from './console_server.mjs';

const { WebSocket } = createRequire(new URL('../../tools/console/package.json', import.meta.url))('ws');
const { TOUCHLINE_PROGRAM: program, TOUCHLINE_BOARD: board } = process.env;

let browser;
let server;
before(async () => {
  browser = await launch();
  // Nobody touches the ball but the test.
  server = await startProgram(program, board, 0, ['--set', 'arena.opponents=stand', '--set', 'control.play.enabled=false']);
});
after(async () => {
  await browser?.close();
  await server?.end();
});

/** A page with control that gets no processor for a second loses it, and rightly so; it is then taken anew. */
const takeControl = async (page) => {
  await show(page, 'play');
  const take = page.locator('button:text-matches("^Take (control|over)$")');
  if (await take.count()) await take.click();
  await page.waitForSelector('text=You have control.');
  await show(page, 'live');
};

/** Messages of these types that the program sends to a second client, from now on. */
async function* messages(...types) {
  const socket = new WebSocket(`${server.url.replace('http', 'ws')}ws`, 'touchline.1');
  try {
    for await (const [data, isBinary] of on(socket, 'message', { close: ['close'] })) {
      const message = isBinary ? {} : JSON.parse(data);
      if (message.type === 'hello') socket.send(JSON.stringify({ type: 'watch', picture: null, state_hz: 60 }));
      if (types.includes(message.type)) yield message;
    }
  } finally {
    socket.close();
  }
}

/** Until a state fulfills `condition`. */
async function waitForState(condition) {
  const limit = Date.now() + PATIENCE_MS;
  for await (const state of messages('state')) {
    if (condition(state)) return state;
    assert.ok(Date.now() < limit, JSON.stringify({ ball: state.ball, ball_track: state.ball_track, number: state.number, halt: state.halt }));
  }
  throw new Error('the program has closed the connection');
}

/** The number of frames so far, when it has not grown for half a second: reports also follow one another at once. */
async function standing() {
  let since;
  for await (const status of messages('status')) {
    if (status.frames !== since?.frames) since = status;
    if (status.time_s - since.time_s >= 0.5) return status.frames;
  }
  throw new Error('the program has closed the connection');
}

const control = (name) => `[data-arena="${name}"]`;
const withControl = async (page, name) => {
  if (await page.isDisabled(control(name))) await takeControl(page);
};
const fill = async (page, name, value) => {
  await withControl(page, name);
  await page.fill(control(name), String(value));
  await page.press(control(name), 'Tab');
};
const press = async (page, name) => {
  await withControl(page, name);
  await page.click(control(name));
};
for (const [width, height] of [[1280, 800], [360, 740]]) {
  test(`the arena is controlled on a page of ${width} x ${height} pixels`, async () => {
    const { page, problems, close } = await open(browser, server.url, { viewport: { width, height } });
    await waitForPicture(page);
    assert.ok(await page.isDisabled(control('pause')), 'without control');
    assert.ok(await page.isDisabled(control('fault')), 'without control');
    await takeControl(page);
    const { scroll, client } = await page.evaluate(() => ({ scroll: document.documentElement.scrollWidth, client: document.documentElement.clientWidth }));
    assert.ok(scroll <= client, `${scroll} > ${client}`);
    assert.deepEqual(await axe(page), []);

    await press(page, 'pause');
    const before = await standing();
    await fill(page, 'frames', 3);
    await press(page, 'step');
    for (let steps = 0; (await standing()) !== before + 3; steps += 1) assert.ok(steps < 10, 'three frames, then the time stands');
    await press(page, 'resume');
    await waitForState((state) => state.number > before + 10);

    // The same seed begins the same game: the ball starts at the same place.
    const begin = async (seed) => {
      await fill(page, 'seed', seed);
      await press(page, 'pause');
      await press(page, 'reset');
      await page.waitForFunction((next) => document.querySelector('[data-arena="seed"]').value === next, String(seed + 1));
      const from = await standing();
      await fill(page, 'frames', 20);
      const seen = waitForState((state) => state.number >= from + 10 && state.ball);
      await press(page, 'step');
      const { ball } = await seen;
      await press(page, 'resume');
      return [ball.x_m, ball.y_m];
    };
    const [first, other, again] = [await begin(5), await begin(6), await begin(5)];
    const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
    assert.ok(apart(first, again) < 0.003, `${first}, ${again}`);
    assert.ok(apart(first, other) > 0.01, `${first}, ${other}`);

    await fill(page, 'ball-speed', 0.6);
    await fill(page, 'direction', 90);
    const { ball_track: rests } = await waitForState((state) => state.ball_track);
    await press(page, 'throw');
    const { ball_track: rolls } = await waitForState((state) => state.ball_track && state.ball_track.vy_mps > 0.3);
    assert.ok(Math.abs(rolls.vx_mps) < 0.2 && rolls.y_m > rests.y_m, JSON.stringify(rolls));

    // Slowly: a second of the arena takes ten.
    await withControl(page, 'speed');
    await page.selectOption(control('speed'), '0.1');
    const reports = messages('status');
    const report = async () => (await reports.next()).value;
    await report();
    const [from, to] = [await report(), await report()];
    await reports.return();
    const rate = (to.frames - from.frames) / (to.time_s - from.time_s);
    assert.ok(rate > 1 && rate < 15, `${rate} frames a second`);
    await page.selectOption(control('speed'), '1');

    await withControl(page, 'fault');
    await page.selectOption(control('fault'), 'camera_lost');
    await fill(page, 'duration', 4);
    const watched = messages('status');
    await watched.next();
    await press(page, 'inject');
    for (let count = 0; ; count += 1) {
      const { value } = await watched.next();
      if (value.lost?.some(({ device }) => device === 'camera') || value.halt?.includes('no_frames')) break;
      assert.ok(count < 30, JSON.stringify(value));
    }
    await watched.return();
    await waitForLink(page, 'Connected');
    assert.deepEqual(problems, []);
    await close();
  });
}

test('the truth of the arena is beside what was recognized', async () => {
  const { page, problems, close } = await open(browser, server.url);
  const seen = await waitForState((state) => state.ball && state.robots.length === state.truth?.robots.length);
  assert.ok(Math.hypot(seen.ball.x_m - seen.truth.ball.x_m, seen.ball.y_m - seen.truth.ball.y_m) < 0.003, JSON.stringify(seen));
  for (const robot of seen.robots) {
    const truth = seen.truth.robots.find(({ team, id }) => team === robot.team && id === robot.id);
    assert.ok(truth && Math.hypot(robot.x_m - truth.x_m, robot.y_m - truth.y_m) < 0.003, JSON.stringify([robot, truth]));
    assert.ok(Math.abs(Math.sin(robot.heading_rad - truth.heading_rad)) < 0.03, JSON.stringify([robot, truth]));
  }
  await page.waitForFunction(() => / robots\s[\d.]+ mm, at most/.test(document.querySelector('[data-truth]')?.textContent ?? ''));
  await page.click('[data-layer="truth"]');
  await page.reload();
  await page.waitForSelector('[data-layer="truth"][aria-pressed="true"]'); // kept, although it is offered only when a state has come
  await page.click('[data-layer="truth"]');
  assert.deepEqual(problems, []);
  await close();
});

test('the ball is dragged in the picture', async () => {
  const { page, problems, close } = await open(browser, server.url);
  await takeControl(page);
  for (let attempt = 1; ; attempt += 1) {
    await takeControl(page);
    await press(page, 'reset'); // the ball is in the middle
    await waitForPicture(page);
    if ((await page.getAttribute('[data-move-objects]', 'aria-pressed')) === 'false') await page.click('[data-move-objects]');
    const { ball } = await waitForState((state) => state.ball && Math.hypot(state.ball.x_m, state.ball.y_m) < 0.2);
    await page.locator('canvas[data-picture]').scrollIntoViewIfNeeded();
    const box = await page.locator('canvas[data-picture]').boundingBox();
    const [width_px, height_px] = [640, 480]; // of the arena's camera
    const scale = Math.min(box.width / width_px, box.height / height_px);
    const at = (u, v) => [box.x + box.width / 2 + (u - (width_px - 1) / 2) * scale, box.y + box.height / 2 + (v - (height_px - 1) / 2) * scale];
    const to = [ball.u_px + 30, ball.v_px + (ball.v_px < 240 ? 45 : -45)];
    await page.mouse.move(...at(ball.u_px, ball.v_px));
    await page.mouse.down();
    await page.mouse.move(...at(...to), { steps: 5 });
    await page.mouse.up();
    let seen;
    for (let count = 0; count < 10; count += 1) {
      ({ ball: seen } = await waitForState((state) => state.ball));
      if (Math.hypot(seen.u_px - to[0], seen.v_px - to[1]) < 6) break;
      await page.waitForTimeout(200);
    }
    if (Math.hypot(seen.u_px - to[0], seen.v_px - to[1]) < 6) break;
    assert.ok(attempt < 4, `the ball is at ${seen.u_px}, ${seen.v_px}, not at ${to}; ${await page.textContent('.notices')}`);
  }
  assert.deepEqual(problems, []);
  await close();
});

test('a board with real devices has no controls of an arena, and refuses its requests', async () => {
  // Poses of another program in the place of a camera.
  const folder = await mkdtemp(join(tmpdir(), 'touchline-'));
  let other;
  try {
    await cp(new URL('../../boards/firasim', import.meta.url), folder, { recursive: true });
    other = await start(program, ['run', '--board', join(folder, 'board.toml'), '--headless', '--console', '127.0.0.1:0'], /http:\/\/127\.0\.0\.1:\d+/);
    const { page, close } = await open(browser, `${other.found}/`);
    await page.waitForSelector('[data-link]');
    await show(page, 'play');
    await page.click('button:text-matches("^Take (control|over)$")');
    await page.waitForSelector('text=You have control.');
    await show(page, 'live');
    await page.waitForSelector('[data-layer="play"]');
    for (const absent of ['[data-arena-panel]', '[data-move-objects]', '[data-layer="truth"]', control('pause')]) assert.equal(await page.locator(absent).count(), 0, absent);
    await close();
    const socket = new WebSocket(`${other.found.replace('http', 'ws')}/ws`, 'touchline.1');
    const requests = [{ type: 'take' }, ...[{ pause: {} }, { reset: { seed: 1 } }, { throw: { vx: 1, vy: 0 } }, { fault: { kind: 'dark', for_s: 1 } }].map((request) => ({ type: 'arena', do: request }))];
    const answers = new Map();
    for await (const [data, isBinary] of on(socket, 'message', { close: ['close'] })) {
      const message = isBinary ? {} : JSON.parse(data);
      if (message.type === 'hello') requests.forEach((request, i) => socket.send(JSON.stringify({ ...request, request: i + 1 })));
      if (message.type === 'answer') answers.set(message.to, message);
      if (answers.size === requests.length) break;
    }
    socket.close();
    assert.equal(answers.get(1).ok, true, 'control is taken');
    for (let i = 2; i <= requests.length; i += 1) {
      assert.equal(answers.get(i).ok, false, JSON.stringify(requests[i - 1]));
      assert.match(answers.get(i).error, /arena|simulat/i);
    }
  } finally {
    await other?.end();
    await rm(folder, { recursive: true, force: true });
  }
});

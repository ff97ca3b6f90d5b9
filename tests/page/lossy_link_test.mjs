// The page behind a link of 1 Mbit/s and 200 ms that loses 5 % of the packets, with the real program, TOUCHLINE_PROGRAM, and its arena,
// TOUCHLINE_BOARD. `lossy-link` starts this on the laptop's side of the link; BOARD_NETWORK and BOARD_ADDRESS are the board's.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { launch, open, show, waitForHalt, waitForLink, waitForPicture } from './browser.mjs';
import { start } from './console_server.mjs';

const { TOUCHLINE_PROGRAM: program, TOUCHLINE_BOARD: board, BOARD_NETWORK: network, BOARD_ADDRESS: address } = process.env;

let browser;
let server;
let folder;
let token;
const stops = []; // when the program said that somebody stopped the robots
let silences = 0; // how often it said that a driver was silent for too long, which stops the robots, too
const readLine = (line) => {
  if (line.includes('stopped the robots')) stops.push(Date.now());
  if (line.includes('was silent for a second')) silences += 1;
};
before(async () => {
  browser = await launch();
  folder = await mkdtemp(join(tmpdir(), 'touchline-'));
  const tokenFile = ['--set', `console.token_file=${join(folder, 'token')}`];
  token = /[0-9a-f]{64}/.exec(execFileSync(program, ['console', '--token', '--board', board, ...tokenFile]).toString())[0];
  const options = ['run', '--board', board, '--headless', '--pace', 'real', '--seed', '1', '--console', `${address}:0`, ...tokenFile];
  server = await start('nsenter', [`--net=${network}`, program, ...options], /http:\/\/198\.51\.100\.1:\d+/, readLine);
});
after(async () => {
  await browser?.close();
  await server?.end();
  if (folder) await rm(folder, { recursive: true, force: true });
});

test('the picture shrinks, and Stop arrives within half a second', async () => {
  const { page, problems, close } = await open(browser, 'about:blank');
  const sizes = []; // of pictures
  page.on('websocket', (socket) => socket.on('framereceived', ({ payload }) => typeof payload !== 'string' && sizes.push(payload.length)));
  await page.goto(`${server.found}/login?token=${token}`);
  await waitForLink(page, 'Connected');
  await waitForPicture(page);
  // What one period of 15 pictures a second can carry.
  const period = 125000 / 15;
  for (let i = 0; !(Math.max(...sizes) > period && sizes.slice(-3).every((size) => size < period)); i += 1) {
    assert.ok(i < 600, `the pictures do not shrink: ${sizes}`);
    await page.waitForTimeout(100);
  }
  await page.evaluate(() => addEventListener('keydown', () => (window.pressedAt = Date.now()), true));
  await show(page, 'play');
  const times = [];
  for (let attempt = 0; times.length < 6; attempt += 1) {
    assert.ok(attempt < 30, `a driver was silent for a second ${silences} times`);
    const silencesBefore = silences;
    await page.click('button:text-matches("^Take (control|over)$")');
    await page.waitForSelector('text=You have control.');
    if (attempt > 0) await page.click('[data-start]:not([disabled])');
    await waitForHalt(page, false);
    // A driver that a link keeps silent for a second stops the robots, too.
    await page.click('button:text-is("Give up control")');
    await page.waitForSelector('text=Nobody has control.');
    // Then there is nothing left to stop.
    if (silences > silencesBefore) continue;
    const before = stops.length;
    await page.keyboard.press('Space');
    await page.waitForSelector('header [data-stop="confirmed"]');
    for (let waited = 0; stops.length === before && waited < 600; waited += 1) await page.waitForTimeout(100);
    times.push(stops[before] - (await page.evaluate(() => window.pressedAt)));
  }
  console.log(`pictures of ${Math.max(...sizes)} to ${sizes.at(-1)} bytes; stops after ${times.join(', ')} ms`);
  times.sort((a, b) => a - b);
  // In one of a hundred the packets of both connections are lost (tests/console/web_lossy_link_test.cpp measures it without a browser).
  assert.ok(times[3] < 500, `stops after ${times.join(', ')} ms`);
  assert.ok(times[0] > 95, 'the link has a delay');
  assert.deepEqual(problems.filter((problem) => problem !== `request to ${new URL(server.found).host}`), []);
  await close();
});

// The page with the real program, TOUCHLINE_PROGRAM, and its arena, TOUCHLINE_BOARD.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtemp, readFile, readdir, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { after, before, test } from 'node:test';
import { PAGES, PATIENCE_MS, axe, hold, launch, open, show, waitForHalt, waitForLink, waitForPicture } from './browser.mjs';
import { startProgram } from './console_server.mjs';

const program = process.env.TOUCHLINE_PROGRAM;
const board = process.env.TOUCHLINE_BOARD;

let browser;
let server;
before(async () => {
  browser = await launch();
  server = await startProgram(program, board);
});
after(async () => {
  await browser?.close();
  await server?.end();
});

const takeControl = async (page) => {
  await show(page, 'play');
  await page.click('button:text-matches("^Take (control|over)$")');
  await page.waitForSelector('text=You have control.');
};
const start = async (page) => {
  await page.click('[data-start]:not([disabled])');
  await waitForHalt(page, false);
};

test('the picture appears, and the overlay belongs to it', async () => {
  const { page, problems, close } = await open(browser, server.url);
  await waitForLink(page, 'Connected');
  await waitForPicture(page);
  const numbers = new Set();
  for (let i = 0; numbers.size < 10; i += 1) {
    const { picture, overlay } = await page.evaluate(() => ({ ...document.querySelector('canvas[data-picture]').dataset }));
    assert.equal(overlay, picture);
    numbers.add(picture);
    await page.waitForFunction((last) => document.querySelector('canvas[data-picture]').dataset.picture !== last, picture);
  }
  const brightest = await page.evaluate(() => {
    const canvas = document.querySelector('canvas[data-picture]');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return data.reduce((most, value, i) => (i % 4 === 3 ? most : Math.max(most, value)), 0);
  });
  assert.ok(brightest > 100, `brightest channel: ${brightest}`);
  assert.deepEqual(problems, []);
  await close();
});

test('the page has at most 300 kB, compressed', async () => {
  const dist = new URL('../../tools/console/dist/', import.meta.url);
  const assets = (await readdir(new URL('assets/', dist))).map((name) => `assets/${name}`);
  const sizes = await Promise.all(['index.html', 'favicon.svg', ...assets].map(async (name) => gzipSync(await readFile(new URL(name, dist))).length));
  const total = sizes.reduce((sum, size) => sum + size, 0);
  console.log(`the page: ${total} bytes compressed`);
  assert.ok(assets.length >= 2 && total <= 300_000, String(total));
});

test('the first picture waits for the files that index.html names, and for no timer', async () => {
  // How long these take depends on the machine and is only printed.
  const named = [...(await (await fetch(server.url)).text()).matchAll(/(?:<script[^>]* src|<link rel="stylesheet"[^>]* href)="([^"]+)"/g)].map(([, path]) => new URL(path, server.url).href);
  assert.equal(named.length, 2, String(named));
  const context = await browser.newContext();
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  await page.addInitScript(() => (window.setTimeout = window.setInterval = () => 0));
  // All other requests are never answered.
  await page.route('**', (route) => [server.url, ...named].includes(route.request().url()) && route.continue());
  const begin = performance.now();
  await page.goto(server.url, { waitUntil: 'commit' });
  await waitForPicture(page);
  console.log(`first picture after ${Math.round(performance.now() - begin)} ms`);
  await context.close();
});

test('by touch: a tap shows a pixel, two fingers zoom, and Stop stops', async () => {
  const driver = await open(browser, server.url);
  await takeControl(driver.page);
  if (await driver.page.locator('[data-start]:not([disabled])').count()) await start(driver.page);
  await driver.page.click('button:text-is("Give up control")');
  await driver.close();
  const { page, problems, close } = await open(browser, server.url, { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true });
  await waitForPicture(page);
  const box = await page.locator('canvas[data-picture]').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.touchscreen.tap(x, y);
  await page.waitForFunction(() => document.querySelector('[data-pixel]').textContent !== '–');
  const fingers = await page.context().newCDPSession(page);
  const touch = (type, apart) => fingers.send('Input.dispatchTouchEvent', { type, touchPoints: apart ? [{ x: x - apart, y, id: 0 }, { x: x + apart, y, id: 1 }] : [] });
  await touch('touchStart', 20);
  for (const apart of [30, 45, 60, 80]) await touch('touchMove', apart);
  await touch('touchEnd', 0);
  await page.waitForFunction(() => Number(document.querySelector('canvas[data-picture]').dataset.zoom) > 2);
  await waitForHalt(page, false);
  await page.tap('header [data-stop]');
  await page.waitForSelector('header [data-stop="confirmed"]');
  await waitForHalt(page, true);
  await takeControl(page);
  await start(page);
  await page.click('button:text-is("Give up control")');
  assert.deepEqual(problems, []);
  await close();
});

test('pointing at the picture shows pixel, color and place', async () => {
  const { page, close } = await open(browser, server.url);
  await waitForPicture(page);
  const box = await page.locator('canvas[data-picture]').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction(() => document.querySelector('[data-pixel]').textContent !== '–');
  const [u, v] = (await page.textContent('[data-pixel]')).split(',').map(Number);
  assert.ok(u > 310 && u < 330 && v > 230 && v < 250, `${u}, ${v}`);
  assert.match(await page.textContent('[data-color]'), /\d+ \d+ \d+ +#[0-9a-f]{6}/);
  const place = (await page.textContent('[data-place]')).replace(' mm', '').split(',').map(Number);
  // The arena's camera is a hand's breadth off the center of the field.
  assert.ok(place.every((mm) => Math.abs(mm) < 250), String(place));
  await page.mouse.wheel(0, -600);
  await page.waitForFunction(() => Number(document.querySelector('canvas[data-picture]').dataset.zoom) > 2);
  await page.dblclick('canvas[data-picture]');
  await page.waitForFunction(() => document.querySelector('canvas[data-picture]').dataset.zoom === '1');
  await close();
});

test('overlays of classes, regions and light belong to the picture', async () => {
  const { page, problems, close } = await open(browser, server.url);
  await waitForPicture(page);
  assert.equal(await page.getAttribute('canvas[data-picture]', 'data-findings'), '', 'only what is watched is sent');
  const toggle = async (layer) => {
    await page.focus(`[data-layer="${layer}"]`);
    await page.keyboard.press('Enter');
  };
  for (const layer of ['robots', 'ball', 'tracks', 'lines']) await toggle(layer);
  for (const layer of ['classes', 'refusals', 'light']) await toggle(layer);
  await page.waitForFunction(() => document.querySelector('canvas[data-findings="classes light regions"]'));
  await page.waitForSelector('[data-light]:has-text("%")');
  // Pixels of a class have exactly the color that the venue file shows it in; a camera's picture has not.
  await toggle('light');
  await page.waitForFunction(() => document.querySelector('canvas[data-findings="classes regions"]'));
  const shown = await page.evaluate(() => {
    const canvas = document.querySelector('canvas[data-picture]');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const counts = new Map();
    for (let i = 0; i < data.length; i += 4) {
      const color = data.slice(i, i + 3).join(' ');
      counts.set(color, (counts.get(color) ?? 0) + 1);
    }
    return [...counts].filter(([color, count]) => {
      const values = color.split(' ').map(Number);
      return count >= 20 && Math.max(...values) - Math.min(...values) > 90;
    });
  });
  assert.ok(shown.length >= 5, `colors of classes: ${shown}`);
  assert.deepEqual(await axe(page), []);
  for (const layer of ['classes', 'refusals']) await toggle(layer);
  await page.waitForFunction(() => document.querySelector('canvas[data-findings=""]'));
  assert.deepEqual(problems, []);
  await close();
});

test('pointing at a pixel shows the class that the camera sees there', async () => {
  const { page, close } = await open(browser, server.url);
  await waitForPicture(page);
  const box = await page.locator('canvas[data-picture]').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForSelector('[data-class]:not([data-class=""])');
  assert.match(await page.textContent('[data-probe]'), /Camera: R G B \d+ \d+ \d+/);
  await page.mouse.move(box.x + 2, box.y - 60);
  await page.waitForFunction(() => document.querySelector('[data-class]').textContent === '–');
  await close();
});

test('score and roles of the arena are shown', async () => {
  const { page, close } = await open(browser, server.url);
  await takeControl(page);
  if (await page.locator('[data-start]:not([disabled])').count()) await start(page);
  await page.waitForFunction(() => /^\d+ : \d+$/.test(document.querySelector('[data-score]')?.textContent ?? ''));
  assert.equal(await page.locator('text=Goal for us').count(), 0, 'the arena counts');
  await page.waitForSelector('tr[data-own] >> text=goalkeeper');
  await page.click('button:text-is("Give up control")');
  await show(page, 'live');
  await page.waitForSelector('[data-decision]:has-text("goalkeeper"):has-text("keep")');
  await page.waitForSelector('[data-decision]:has-text("attacker"):has-text("attack: ")');
  assert.equal(await page.locator('[data-decision]').count(), 5);
  await page.click('[data-layer="play"]');
  assert.deepEqual(await axe(page), []);
  await show(page, 'timing');
  await page.waitForSelector('dt:text-is("of these stop packets")');
  await page.waitForSelector('dt:text-is("Refused")');
  await close();
});

test('Stop works from every page, by button and by space bar, without control', async () => {
  const driver = await open(browser, server.url);
  await takeControl(driver.page);
  const { page, problems, close } = await open(browser, server.url);
  for (const name of PAGES) {
    await show(page, name);
    for (const press of [() => page.click('header [data-stop]'), () => page.keyboard.press('Space')]) {
      await waitForHalt(page, false);
      await press();
      await page.waitForSelector('header [data-stop="confirmed"]');
      await waitForHalt(page, true);
      await waitForHalt(driver.page, true);
      await start(driver.page);
    }
  }
  assert.deepEqual(problems, []);
  await close();
  await driver.close();
});

test('one screen has control, and another one takes over', async () => {
  const first = await open(browser, server.url);
  const second = await open(browser, server.url);
  await takeControl(first.page);
  await show(second.page, 'play');
  await second.page.waitForSelector('[data-driver]:has-text("has control")');
  await second.page.click('button:text-is("Take over")');
  await second.page.waitForSelector('text=You have control.');
  await first.page.waitForSelector('button:text-is("Take over")');
  await first.close();
  await second.page.click('button:text-is("Give up control")');
  await second.page.waitForSelector('text=Nobody has control.');
  await second.close();
});

test('a robot is driven while a key is held', async () => {
  const { page, close } = await open(browser, server.url);
  await takeControl(page);
  if (await page.locator('[data-start]:not([disabled])').count()) await start(page);
  await page.click('[data-robot="2"]');
  await hold(page, () => page.keyboard.down('KeyW'), () => page.keyboard.up('KeyW'), 'tr[data-own="2"] >> text=this console');
  await page.keyboard.up('KeyW');
  await page.waitForSelector('[data-driving]:has-text("0.00 m/s")');
  await page.click('button:text-is("Give up control")');
  await page.waitForSelector('tr[data-own="2"] >> text=built-in play');
  await close();
});

test('robots stop when the driver disappears', async () => {
  const watcher = await open(browser, server.url);
  const driver = await open(browser, server.url);
  await takeControl(driver.page);
  if (await driver.page.locator('[data-start]:not([disabled])').count()) await start(driver.page);
  await driver.close();
  await waitForHalt(watcher.page, true);
  await takeControl(watcher.page);
  await start(watcher.page);
  await watcher.page.click('button:text-is("Give up control")');
  await watcher.close();
});

test('the timing page has figures, and the report can be downloaded', async () => {
  const { page, problems, close } = await open(browser, server.url);
  await show(page, 'timing');
  await page.waitForFunction(() => Number(document.querySelector('tbody tr td:nth-child(2)')?.textContent) > 0);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('text=Download the report')]);
  const chunks = [];
  for await (const chunk of await download.createReadStream()) chunks.push(chunk);
  const report = JSON.parse(Buffer.concat(chunks).toString());
  assert.ok(report.status.latency.start.count > 0 && report.hello.board.length > 0);
  assert.deepEqual(problems, []);
  await close();
});

test('a bug report can be downloaded, and tar unpacks it', async () => {
  const { page, problems, close } = await open(browser, server.url);
  await show(page, 'timing');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('text=Download a bug report')]);
  assert.match(download.suggestedFilename(), /^touchline-bug-report-\d{8}-\d{6}\.tar\.gz$/);
  const folder = await mkdtemp(join(tmpdir(), 'touchline-'));
  try {
    await download.saveAs(join(folder, 'report.tar.gz'));
    execFileSync('tar', ['--extract', '--file', join(folder, 'report.tar.gz'), '--strip-components=1', '--directory', folder]);
    const results = (await readFile(join(folder, 'results.jsonl'), 'utf8')).trim().split('\n').map((line) => JSON.parse(line));
    assert.ok(results.length > 1 && results.every((state) => state.type === 'state'));
    assert.deepEqual((await readdir(join(folder, 'files'))).sort().filter((name) => name.endsWith('.toml')), ['board.toml', 'team.toml', 'venue.toml']);
    assert.equal((await readFile(join(folder, 'picture.png'))).toString('latin1', 1, 4), 'PNG');
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
  assert.deepEqual(problems, []);
  await close();
});

test('a lost link is shown, nothing old looks live, and the page recovers', async () => {
  const { page, close } = await open(browser, server.url);
  await waitForPicture(page);
  await server.end('SIGKILL');
  await waitForLink(page, 'No connection');
  await page.waitForSelector('[data-notice="lost"]');
  await page.waitForSelector('canvas[data-picture].stale');
  await page.waitForSelector('.halt:has-text("State unknown")');
  server = await startProgram(program, board, server.port);
  await waitForLink(page, 'Connected');
  await page.waitForSelector('[data-notice="returned"]');
  await waitForPicture(page);
  assert.equal(await page.locator('canvas.stale').count(), 0);
  await close();
});

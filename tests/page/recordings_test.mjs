// The page Recordings with the real program, TOUCHLINE_PROGRAM, and its arena, TOUCHLINE_BOARD: a game is recorded with the button, then
// played, stepped through, downloaded and deleted.
import assert from 'node:assert/strict';
import { mkdtemp, open as openFile, readFile, readdir, rm, stat, symlink, truncate, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { axe, launch, open, show, waitForHalt } from './browser.mjs';
import { startProgram } from './console_server.mjs';

const { TOUCHLINE_PROGRAM: program, TOUCHLINE_BOARD: board } = process.env;
// Where this is set, the pages are also kept as pictures for people to look at.
const pictures = process.env.TOUCHLINE_PAGE_PICTURES;

let browser;
let server;
let folder;
before(async () => {
  folder = await mkdtemp(join(tmpdir(), 'touchline-recordings-'));
  browser = await launch();
  // A short picture period would fill the disk: every fourth picture is enough here.
  server = await startProgram(program, board, 0, ['--set', `recording.folder=${folder}`, '--set', 'recording.automatic=off', '--set', 'recording.reserve_mb=0', '--set', 'recording.every=4']);
});
after(async () => {
  await browser?.close();
  await server?.end();
  await rm(folder, { recursive: true, force: true });
});

/** A page with control that gets no processor for a second loses it, and rightly so; it is then taken anew. */
const takeControl = async (page) => {
  await show(page, 'play');
  const take = page.locator('button:text-matches("^Take (control|over)$")');
  if (await take.count()) await take.click();
  await page.waitForSelector('text=You have control.');
};
const withControl = async (page, selector) => {
  if (await page.isDisabled(selector)) await takeControl(page);
  await show(page, 'recordings');
};
const keep = async (page, name) => pictures && (await page.screenshot({ path: join(pictures, `${name}.png`), fullPage: true }));
const frame = (page) => page.getAttribute('[data-frame]', 'data-frame').then(Number);
const waitForFrame = (page, number) => page.waitForFunction((wanted) => document.querySelector('[data-frame]')?.dataset.frame === String(wanted), number);
const waitForDrawn = (page, number) => page.waitForFunction((wanted) => document.querySelector('canvas[data-picture]')?.dataset.picture === String(wanted), number);
const fits = async (page) => {
  const { scroll, client } = await page.evaluate(() => ({ scroll: document.documentElement.scrollWidth, client: document.documentElement.clientWidth }));
  assert.ok(scroll <= client, `${scroll} > ${client}`);
};
const listed = (name) => `[data-listed="${name}"]`;

for (const [width, height] of [[1280, 800], [360, 740]]) {
  test(`a game is recorded, looked at, downloaded and deleted on a page of ${width} x ${height} pixels`, async () => {
    const { page, problems, close } = await open(browser, server.url, { viewport: { width, height } });
    await show(page, 'recordings');
    await page.waitForSelector('[data-record="start"]');
    assert.ok(await page.isDisabled('[data-record="start"]'), 'without control');

    await takeControl(page);
    if (await page.locator('[data-start]:not([disabled])').count()) await page.click('[data-start]');
    await waitForHalt(page, false);
    await show(page, 'recordings');
    await withControl(page, '[data-record="start"]');
    await page.click('[data-record="start"]');
    await page.waitForSelector('[data-recording="on"]');
    await page.waitForFunction(() => /[1-9]\d* s, \d/.test(document.querySelector('[data-recording]').textContent));
    await page.waitForSelector('[data-growing]');
    const name = await page.getAttribute('tr:has([data-growing])', 'data-listed');
    assert.ok((await readdir(folder)).includes(name), name);
    assert.match(name, /^touchline-\d{4}(-\d{8}-\d{6})?\.mcap$/);
    assert.ok(await page.isDisabled(`${listed(name)} [data-delete]`), 'it is being written');
    await keep(page, `recording-${width}`);
    // A stop, for a jump.
    await page.keyboard.press('Space');
    await waitForHalt(page, true);
    await page.waitForTimeout(500);
    await withControl(page, '[data-record="stop"]');
    await page.click('[data-record="stop"]');
    await page.waitForSelector('[data-recording="off"]');
    assert.equal(await page.textContent('[data-record-ended]'), 'ended on the page');
    await page.waitForFunction((row) => document.querySelector(row) && !document.querySelector('[data-growing]'), listed(name));

    await page.click(`${listed(name)} .name`);
    await waitForFrame(page, 0);
    await waitForDrawn(page, 0);
    assert.deepEqual(await axe(page), []);
    await fits(page);
    // Step by step: each picture has the results of its own frame.
    for (const number of [1, 2, 3]) {
      await page.click('[data-step="on"]');
      await waitForDrawn(page, number);
      await waitForFrame(page, number);
    }
    await page.click('[data-step="back"]');
    await waitForDrawn(page, 2);
    await page.focus('[data-timeline]');
    await page.keyboard.press('ArrowRight');
    await waitForDrawn(page, 3);

    // A busy computer may have stopped them before, because frames were late.
    const pressed = '[data-event="stop"][aria-current]:has-text("Stop was pressed")';
    for (let jumps = 0; !(await page.locator(pressed).count()); jumps += 1) {
      assert.ok(jumps < 20, await page.textContent('.events'));
      const before = await frame(page);
      await page.click('[data-jump="stop"]');
      await page.waitForFunction((last) => Number(document.querySelector('[data-frame]').dataset.frame) !== last, before);
    }
    const stopped = await frame(page);
    await waitForDrawn(page, stopped);
    // The recorded results say so as well: from this frame on, the halt is there.
    const halts = await page.evaluate(async ([address, from]) => {
      const data = await (await fetch(`${address}/frames?from=${from}&count=2`)).arrayBuffer();
      const view = new DataView(data);
      const states = [];
      for (let place = 0; place < data.byteLength; ) {
        const [state, jpeg] = [view.getUint32(place + 8, true), view.getUint32(place + 12, true)];
        states.push(JSON.parse(new TextDecoder().decode(new Uint8Array(data, place + 16, state))).halt);
        place += 16 + state + jpeg;
      }
      return states;
    }, [`recordings/${name}`, stopped - 1]);
    assert.ok(!halts[0].includes('console') && halts[1].includes('console'), JSON.stringify(halts));
    await keep(page, `stop-${width}`);

    await page.click('[data-step="back"]');
    await waitForFrame(page, stopped - 1);
    await page.evaluate(() => (document.querySelector('[data-timeline]').value = '0', document.querySelector('[data-timeline]').dispatchEvent(new Event('input', { bubbles: true }))));
    await waitForFrame(page, 0);
    await page.selectOption('[data-speed]', '4');
    await page.click('[data-play-pause]');
    await page.waitForFunction(() => document.querySelector('[data-play-pause]').textContent === 'Play');
    const last = Number(await page.getAttribute('[data-timeline]', 'max'));
    await waitForFrame(page, last);
    await page.selectOption('[data-speed]', '0.25');
    await page.click('[data-play-pause]');
    await page.waitForFunction(() => Number(document.querySelector('[data-frame]').dataset.frame) > 5);
    await page.click('[data-play-pause]');
    assert.ok((await frame(page)) < last, 'slowly, and paused');

    const [download] = await Promise.all([page.waitForEvent('download'), page.click(`${listed(name)} [data-download]`)]);
    assert.equal(download.suggestedFilename(), name);
    assert.ok((await readFile(await download.path())).equals(await readFile(join(folder, name))), 'the file as it is on the disk');

    await withControl(page, `${listed(name)} [data-delete]`);
    await page.click(`${listed(name)} [data-delete]`);
    await page.click('text=Keep it');
    await stat(join(folder, name));
    await page.click(`${listed(name)} [data-delete]`);
    await page.click('[data-confirm]');
    await page.waitForFunction((row) => !document.querySelector(row), listed(name));
    await assert.rejects(stat(join(folder, name)));
    assert.equal(await page.locator('[data-shown]').count(), 0, 'what was deleted is no longer shown');
    assert.deepEqual(problems, []);
    await close();
  });
}

test('a file that is cut off, or no recording, says so; nothing outside the folder is served', async () => {
  const { page, close } = await open(browser, server.url);
  await takeControl(page);
  await show(page, 'recordings');
  await page.click('[data-record="start"]');
  await page.waitForFunction(() => /[2-9]\d* s, \d/.test(document.querySelector('[data-recording="on"]')?.textContent ?? ''));
  await page.waitForSelector('[data-growing]');
  const name = await page.getAttribute('tr:has([data-growing])', 'data-listed');
  await withControl(page, '[data-record="stop"]');
  await page.click('[data-record="stop"]');
  await page.waitForSelector('[data-recording="off"]');
  const { size } = await stat(join(folder, name));
  await truncate(join(folder, name), Math.floor(0.7 * size));
  await writeFile(join(folder, 'touchline-0900.mcap'), 'no recording');
  await writeFile(join(folder, 'secret.txt'), 'secret');
  await symlink(board, join(folder, 'link.mcap'));
  await page.reload();
  await page.waitForSelector(`${listed('touchline-0900.mcap')} [data-unreadable]`);
  assert.match(await page.textContent(`${listed('touchline-0900.mcap')} [data-unreadable]`), /touchline-0900\.mcap: is not a recording/);
  await page.waitForSelector(`${listed(name)} [data-cut]`);
  await page.click(`${listed(name)} .name`);
  await page.waitForSelector('[data-incomplete]');
  await waitForDrawn(page, 0);
  // A frame in a damaged chunk, after the file was opened.
  const file = await openFile(join(folder, name), 'r+');
  await file.write('damage', Math.floor(0.35 * size));
  await file.close();
  await page.selectOption('[data-speed]', '8');
  await page.click('[data-play-pause]');
  await page.waitForFunction(() => document.querySelector('[data-play-pause]').textContent === 'Play');
  await waitForFrame(page, Number(await page.getAttribute('[data-timeline]', 'max')));
  await keep(page, 'damaged');

  for (const [path, status] of [['recordings/link.mcap', 404], ['recordings/secret.txt/file', 404], ['recordings/..%2Fboard.toml/file', 404], ['recordings/%2e%2e/board.toml', 404], [`recordings/${encodeURIComponent(join(folder, name))}/file`, 404], ['recordings/touchline-0900.mcap', 500], [`recordings/${name}/frames?from=999999`, 400]]) {
    const answer = await page.request.get(`${server.url}${path}`);
    assert.equal(answer.status(), status, `${path}: ${await answer.text()}`);
    assert.ok(!(await answer.text()).includes('[camera]'), path);
  }
  await close();
});

// A color whose name is markup, and a camera that is unplugged, with the real program, TOUCHLINE_PROGRAM, and its arena, TOUCHLINE_BOARD.
import assert from 'node:assert/strict';
import { cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { PAGES, launch, open, show, waitForLink, waitForPicture } from './browser.mjs';
import { startProgram } from './console_server.mjs';

const name = '<script>window.hacked=1</script><img src=x onerror=window.hacked=1>';
let browser;
let folder;
before(async () => {
  browser = await launch();
  folder = await mkdtemp(join(tmpdir(), 'touchline-'));
});
after(async () => {
  await browser?.close();
  await rm(folder, { recursive: true, force: true });
});

/** Runs with a copy of the board's files, changed. */
async function withBoard(files, change, run) {
  const copy = join(folder, String(Math.random()));
  await cp(dirname(process.env.TOUCHLINE_BOARD), copy, { recursive: true });
  for (const file of files) await writeFile(join(copy, file), change(await readFile(join(copy, file), 'utf8')));
  const server = await startProgram(process.env.TOUCHLINE_PROGRAM, join(copy, 'board.toml'));
  const opened = await open(browser, server.url);
  try {
    await run(opened.page, opened.problems);
  } finally {
    await opened.close();
    await server.end();
  }
}

test('the name of a color is text on every page', () =>
  withBoard(['venue.toml', 'team.toml', 'board.toml'], (text) => text.replaceAll('"orange"', JSON.stringify(name)), async (page, problems) => {
    await waitForPicture(page);
    for (const each of PAGES) {
      await show(page, each);
      await waitForLink(page, 'Connected');
    }
    assert.equal(await page.evaluate(() => window.hacked), undefined);
    assert.equal(await page.locator('main script, main img[src="x"]').count(), 0);
    assert.deepEqual(problems, []);
  }));

// Again and again, so that a slow browser sees it, too: 20 s without camera, 20 s with it.
const faults = Array.from({ length: 30 }, (_, i) => `[[arena.fault]]\nkind = "camera_lost"\nat_s = ${10 + 40 * i}\nfor_s = 20\n`).join('\n');

test('the camera is unplugged: the page says so, stop is confirmed, and it goes on when the camera is back', () =>
  withBoard(['board.toml'], (text) => `${text}\n${faults}`, async (page, problems) => {
    await waitForLink(page, 'Connected');
    await page.waitForSelector('[data-link^="No frames"]');
    await page.waitForSelector('[data-halt~="no_frames"]:has-text("Robots stopped"):has-text("no picture from the camera")');
    await show(page, 'play');
    await page.waitForSelector('[data-reasons]:has-text("Check the camera and its cable")');
    await page.keyboard.press('Space');
    await page.waitForSelector('header [data-stop="confirmed"]');
    await page.waitForSelector('[data-halt~="console"]');
    await show(page, 'timing');
    await page.waitForSelector('.log:has-text("camera")');
    await waitForLink(page, 'Connected');
    await page.waitForFunction(() => !document.querySelector('[data-halt]').dataset.halt.includes('no_frames'));
    // The camera's return starts nobody.
    await page.waitForSelector('[data-halt~="console"]');
    await show(page, 'live');
    await waitForPicture(page);
    assert.deepEqual(problems, []);
  }));

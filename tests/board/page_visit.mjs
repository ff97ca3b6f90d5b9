// What a person does in the browser on a bare board, for tests/board/page.py: LINK is the printed login link. A line `do NAME` on standard output
// asks for an action, whose answer is a line of standard input; `ok TEXT` is a check that held. SCREENSHOTS gets pictures.
import assert from 'node:assert/strict';
import { createInterface } from 'node:readline';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { hold, launch, open, show, waitForPicture } from '../page/browser.mjs';
import { act, begin, next } from '../page/setup_steps.mjs';

const [link] = process.argv.slice(2);
const answers = createInterface({ input: process.stdin })[Symbol.asyncIterator]();
const ask = async (name) => {
  console.log(`do ${name}`);
  return (await answers.next()).value;
};
const begun = Date.now();
let pictures = 0;
const ok = async (text) => {
  await page.screenshot({ path: join(process.env.SCREENSHOTS, `${String((pictures += 1)).padStart(2, '0')}.png`), fullPage: true });
  console.log(`ok ${text} (${Math.round((Date.now() - begun) / 1000)} s)`);
};

const browser = await launch();
const { page, problems } = await open(browser, link);
// What the page shows now: an emulated board may take minutes for a step.
const look = async () => {
  await page.screenshot({ path: join(process.env.SCREENSHOTS, 'now.png'), fullPage: true });
  writeFileSync(join(process.env.SCREENSHOTS, 'now.txt'), await page.innerText('main'));
};
const watching = setInterval(() => look().catch(() => {}), 15_000);
try {
  await page.waitForSelector('[data-halt]:has-text("camera")');
  await ok('the link opens the page without camera and radio, and the header says what is missing');
  await show(page, 'setup');
  await page.waitForSelector('[data-cameras="0"]');
  await ok('Set up says that there is no camera');
  await ask('plug_camera');
  await page.click('[data-look-again]:not([disabled])').catch(() => {});
  await page.click('[data-choose-camera]:not([disabled])');
  await page.waitForSelector('[data-step="camera"]');
  await waitForPicture(page);
  await ok('a camera that is plugged in is listed, and chosen with two presses');
  await act(page, 'camera');
  await next(page, 'field');
  await page.selectOption('[data-preset]:not([disabled])', 'mirosot-middle');
  await page.fill('[data-height]', '2.3');
  await act(page, 'field');
  await ok('the field is found');
  await next(page, 'light');
  await act(page, 'light');
  await ok('the light is measured');
  await next(page, 'robots');
  await page.waitForSelector('[data-top="own-4"]');
  await act(page, 'robots');
  await ok('the robots are described');
  await next(page, 'colors');
  await act(page, 'colors');
  console.log(await page.innerText('[data-step="colors"]'));
  await ok('the colors are found');
  await next(page, 'radio');
  const port = '[data-port^="/dev/serial/by-id/"]';
  await page.check(`${port} input:not([disabled])`);
  await page.waitForSelector(`${port} input:checked:not([disabled])`);
  await ok(`the radio's port is chosen: ${await page.getAttribute(port, 'data-port')}`);
  await page.click('[data-robot="2"]:not([disabled])');
  await hold(page, () => page.keyboard.down('KeyW'), () => page.keyboard.up('KeyW'), '[data-driving]:text-matches("^0.[1-9]")');
  await page.keyboard.up('KeyW');
  await act(page, 'radio');
  await next(page);
  await page.click('[data-confirm-save]:not([disabled])');
  await page.waitForSelector('[data-message]:has-text("Saved")');
  await ok('the files are written');
  await page.click('[data-to-play]');
  const before = Number(await ask('path'));
  // The program begins anew with the saved files, and a Start before that does not count.
  for (;;) {
    await page.click('[data-start]:not([disabled])');
    if (await page.waitForSelector('[data-halt=""]', { timeout: 10_000 }).catch(() => null)) break;
  }
  // A page with control that gets no processor for a second would stop the robots.
  await page.click('button:text-is("Give up control")');
  await page.waitForSelector('[data-halt=""]');
  await ok('Start: robots may move');
  for (let moved = 0; moved < 1; moved = Number(await ask('path')) - before) await page.waitForTimeout(2000);
  await ok('the robots moved more than a meter in all');
  await page.keyboard.press('Space');
  await page.waitForSelector('header [data-stop="confirmed"]');
  await ok('the space bar stops them');
  assert.deepEqual(problems, []);
} catch (error) {
  await page.screenshot({ path: join(process.env.SCREENSHOTS, 'error.png'), fullPage: true });
  console.log(String(error));
  process.exitCode = 1;
}
clearInterval(watching);
await browser.close();
process.exit();

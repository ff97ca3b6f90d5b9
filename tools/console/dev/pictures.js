// Makes all pictures of docs/console.md: node dev/pictures.js TOUCHLINE TOUCHLINE_SETUP [FOLDER]
// It sets a copy of the arena up from nothing, step by step, and then plays. FOLDER (default: docs) gets the pictures.
import { cp, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { hold, launch, open, show, waitForHalt, waitForPicture } from '../../../tests/page/browser.mjs';
import { startProgram, startSetup } from '../../../tests/page/console_server.mjs';
import { act, begin, next } from '../../../tests/page/setup_steps.mjs';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const [program, setupProgram, folder = join(root, 'docs')] = process.argv.slice(2);
const work = await mkdtemp(join(tmpdir(), 'touchline-pictures-'));
for (const name of ['board.toml', 'team.toml']) await cp(join(root, 'boards/mock', name), join(work, name));
await writeFile(join(work, 'venue.toml'), 'version = 1\n');
const board = join(work, 'board.toml');
const setup = await startSetup(setupProgram, board, join(work, 'state'), join(work, 'setup.sock'));
const server = await startProgram(program, board, 0, ['--set', `console.setup_socket=${join(work, 'setup.sock')}`, '--set', 'arena.opponents=stand']);
const browser = await launch();
const PATIENT_MS = 3000; // trails, charts
const save = async (page, name) => {
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: join(folder, `console-${name}.jpg`), type: 'jpeg', quality: 82 });
  console.log(name);
};
const laptop = { viewport: { width: 1280, height: 800 }, colorScheme: 'light' };
const { page, close } = await open(browser, `${server.url}#setup`, laptop);

async function setUp() {
  await begin(page);
  await waitForPicture(page);
  await page.waitForSelector('[data-live="true"]');
  const fill = async (label, value) => {
    const field = page.locator(`.key:has(label:has-text("${label}")) input[type="number"]:not([disabled])`);
    await field.fill(value);
    await field.press('Tab');
  };
  await fill('Exposure', '2800');
  await fill('Gain', '220');
  await act(page, 'camera');
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'step-camera');
  await next(page, 'field');
  await page.selectOption('[data-preset]:not([disabled])', 'mirosot-middle');
  await page.fill('[data-height]', '2.3');
  await act(page, 'field');
  await page.waitForSelector('[data-error-map]');
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'setup');
  await next(page, 'light');
  await act(page, 'light');
  await page.waitForSelector('[data-after]');
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'step-light');
  await next(page, 'robots');
  await page.waitForSelector('[data-top="own-4"]');
  await page.fill('[data-ball-radius]:not([disabled])', '21.35');
  await act(page, 'robots');
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'step-robots');
  await next(page, 'colors');
  await act(page, 'colors');
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'step-colors');
  await next(page, 'radio');
  await act(page, 'radio');
  await next(page);
  await page.waitForSelector('[data-save-panel] .added');
  await page.waitForTimeout(1000);
  await save(page, 'step-save');
  await page.click('[data-confirm-save]:not([disabled])');
  await page.waitForSelector('[data-message]:has-text("Saved")');
  await page.click('[data-to-play]');
}

async function startToPlay() {
  const take = page.locator('button:text-matches("^Take (control|over)$")');
  if (await take.count()) await take.click();
  await page.click('[data-start]:not([disabled])');
  await waitForHalt(page, false);
}

async function play() {
  await startToPlay();
  await page.click('[data-robot="2"]:not([disabled])');
  await hold(page, () => page.keyboard.down('KeyW'), () => page.keyboard.up('KeyW'), '[data-driving]:text-matches("^0.[1-9]")');
  await page.waitForTimeout(700);
  await save(page, 'play');
  await page.keyboard.up('KeyW');
  await page.click('[data-robot="2"]');
  await page.click('button:text-is("Give up control")');
  await show(page, 'live');
  await page.click('[data-layer="trails"]');
  await waitForPicture(page);
  const box = await page.locator('canvas[data-picture]').boundingBox();
  await page.mouse.move(box.x + 0.35 * box.width, box.y + 0.4 * box.height);
  await page.waitForTimeout(2 * PATIENT_MS);
  await save(page, 'live');
  for (const layer of ['trails', 'tracks', 'lines', 'classes', 'refusals', 'interest']) await page.click(`[data-layer="${layer}"]`);
  await page.setViewportSize({ width: 1280, height: 900 });
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'classes');
  await page.setViewportSize(laptop.viewport);
  await show(page, 'timing');
  await page.waitForTimeout(PATIENT_MS);
  await save(page, 'timing');
}

/** Live, Play, Timing and Set up on three devices, in one picture. */
async function forms() {
  const rows = [];
  for (const [width, height, colorScheme, shown] of [[1280, 800, 'dark', 384], [768, 1024, 'light', 230], [360, 740, 'dark', 146]]) {
    const other = await open(browser, server.url, { viewport: { width, height }, colorScheme, hasTouch: width < 1000 });
    for (const name of ['live', 'play', 'timing', 'setup']) {
      await show(other.page, name);
      if (name === 'setup') {
        await begin(other.page);
        await other.page.click('[data-goto="field"]');
      }
      await other.page.waitForTimeout(PATIENT_MS);
      rows.push({ shown, png: (await other.page.screenshot()).toString('base64') });
    }
    await other.page.click('.menu summary');
    await other.page.click('[data-discard]:not([disabled])');
    await other.page.click('[data-confirm-discard]');
    await other.page.waitForSelector('[data-begin]');
    await other.close();
  }
  const sheet = await browser.newPage({ viewport: { width: 1602, height: 100 } });
  const images = rows.map(({ shown, png }) => `<img style="width:${shown}px;display:block" src="data:image/png;base64,${png}">`);
  const row = (some) => `<div style="display:flex;gap:10px;justify-content:space-between;align-items:start">${some.join('')}</div>`;
  await sheet.setContent(`<body style="margin:0"><main style="background:#777;padding:10px;display:grid;gap:10px">${row(images.slice(0, 4))}${row(images.slice(4))}</main>`);
  await sheet.locator('main').screenshot({ path: join(folder, 'console-forms.jpg'), type: 'jpeg', quality: 82 });
  console.log('forms');
}

async function stopOnAPhone() {
  const phone = await open(browser, server.url, { viewport: { width: 360, height: 700 }, isMobile: true, hasTouch: true, colorScheme: 'light' });
  await waitForPicture(phone.page);
  await phone.page.tap('header [data-stop]');
  await phone.page.waitForSelector('header [data-stop="confirmed"]');
  await phone.page.waitForTimeout(500);
  await save(phone.page, 'phone');
  await phone.close();
}

try {
  await setUp();
  await play();
  await forms();
  await stopOnAPhone();
  await close();
} finally {
  await browser.close();
  await server.end();
  await setup.end();
  await rm(work, { recursive: true, force: true });
}

// A phone of 360 pixels that opens the printed login link from another computer: `touchline run --lan`, the program TOUCHLINE_PROGRAM with the
// arena TOUCHLINE_BOARD, in the namespace BOARD_SPACE, and Chromium in PHONE_SPACE (tests/page/second_machine makes both). SCREENSHOTS, a
// folder, gets a picture of every page and step.
import assert from 'node:assert/strict';
import { chmod, cp, mkdtemp, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { PAGES, axe, launch, open, show, waitForHalt, waitForLink, waitForPicture } from './browser.mjs';
import { start, startSetup } from './console_server.mjs';
import { begin } from './setup_steps.mjs';

const { TOUCHLINE_PROGRAM: program, TOUCHLINE_SETUP: setupProgram, TOUCHLINE_BOARD: original, BOARD_SPACE, PHONE_SPACE, SCREENSHOTS } = process.env;
const WIDTH = 360;
const PHONE = { viewport: { width: WIDTH, height: 740 }, hasTouch: true, isMobile: true };
const LEAST_TARGET_PX = 24; // WCAG 2.2, success criterion 2.5.8

let folder;
let setup;
let server;
let browser;
before(async () => {
  folder = await mkdtemp(join(tmpdir(), 'touchline-phone-'));
  for (const name of await readdir(dirname(original))) if (/\.(toml|png)$/.test(name)) await cp(join(dirname(original), name), join(folder, name));
  const board = join(folder, basename(original));
  const socket = join(folder, 'setup.sock');
  setup = await startSetup(setupProgram, board, join(folder, 'state'), socket);
  // `script` is a terminal: links are printed to nothing else.
  process.env.XDG_STATE_HOME = folder;
  const command = `exec ip netns exec ${BOARD_SPACE} ${program} run --board ${board} --headless --pace real --seed 1 --lan --set console.setup_socket=${socket}`;
  server = await start('script', ['--quiet', '--flush', '--return', '--command', command, '/dev/null'], /http:\/\/192\.168\.77\.1:\d+\/login\?token=[0-9a-f]{64}/);
  const chromium = join(folder, 'chromium');
  await writeFile(chromium, `#!/bin/sh\nexec ip netns exec ${PHONE_SPACE} ${process.env.CHROMIUM} "$@"\n`);
  await chmod(chromium, 0o755);
  process.env.CHROMIUM = chromium;
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.end();
  await setup?.end();
  if (folder) await rm(folder, { recursive: true, force: true });
});

/** What does not fit into the width, and every button that cannot be pressed: too small, outside the window, or under something else. */
async function findings(page) {
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  const wide = await page.evaluate((width) => (
    // What a container with its own scroll bar holds may be wider.
    [...document.querySelectorAll('body *')]
      .filter((element) => {
        for (let parent = element.parentElement; parent; parent = parent.parentElement) if (getComputedStyle(parent).overflowX !== 'visible') return false;
        const { left, right, width: own } = element.getBoundingClientRect();
        return own > 0 && (left < -1 || right > width + 1) && !element.matches('[href="#main"]'); // the skip link shows when it has the focus
      })
      .map((element) => `too wide: ${element.outerHTML.slice(0, 100)}`)
  ), WIDTH);
  const buttons = page.locator('button:visible, nav a:visible, summary:visible, select:visible, input:not([tabindex="-1"]):visible');
  const covered = await buttons.evaluateAll((elements, least) => {
    const bad = [];
    for (const element of elements) {
      element.scrollIntoView({ block: 'center', behavior: 'instant' });
      const target = element.matches('input[type="radio"], input[type="checkbox"]') ? element.closest('label') ?? element : element;
      const { left, right, top, bottom, width, height } = target.getBoundingClientRect();
      const hit = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
      const reached = hit !== null && (target.contains(hit) || hit.contains(target));
      if (element.matches('input') && element.scrollWidth > element.clientWidth) bad.push(`cut text: ${element.value}`);
      if (!reached || width < least || height < least) bad.push(`${element.outerHTML.slice(0, 120)} ${Math.round(width)} x ${Math.round(height)} ${reached ? '' : `covered by ${hit?.outerHTML.slice(0, 80)}`}`);
    }
    scrollTo(0, 0);
    return bad;
  }, LEAST_TARGET_PX);
  return [...(width > WIDTH ? [`the page is ${width} pixels wide`] : []), ...wide, ...covered];
}

async function look(page, name) {
  if (SCREENSHOTS) await page.screenshot({ path: join(SCREENSHOTS, `${name}.png`), fullPage: true });
  assert.deepEqual(await findings(page), [], name);
}

test('without the link the board says how to get it', async () => {
  const context = await browser.newContext(PHONE);
  const page = await context.newPage();
  const answer = await page.goto(new URL('/', server.found).href);
  assert.equal(answer.status(), 401);
  assert.match(await page.textContent('body'), /login link/);
  if (SCREENSHOTS) await page.screenshot({ path: join(SCREENSHOTS, 'refused.png') });
  await context.close();
});

test('the printed link opens the page on a phone: picture, Stop, set-up', async () => {
  const { page, problems, close } = await open(browser, server.found, PHONE);
  await waitForLink(page, 'Connected');
  assert.ok(!page.url().includes('token'), 'the token does not stay in the address');
  await waitForPicture(page);
  for (const name of PAGES) {
    await show(page, name);
    await look(page, name);
    assert.deepEqual(await axe(page), [], name);
  }
  await begin(page);
  for (const step of ['camera', 'field', 'light', 'robots', 'colors', 'radio']) {
    await page.tap(`[data-goto="${step}"]`);
    await page.waitForSelector(`[data-step="${step}"]`);
    await waitForPicture(page);
    await look(page, `setup-${step}`);
  }
  await page.tap('.menu summary');
  await page.tap('[data-discard]');
  await page.tap('[data-confirm-discard]');
  await page.waitForSelector('[data-message]:has-text("discarded")');
  await show(page, 'play');
  await page.tap('[data-start]:not([disabled])');
  await waitForHalt(page, false);
  await look(page, 'play-control');
  await page.tap('header [data-stop]');
  await page.waitForSelector('header [data-stop="confirmed"]');
  assert.match(server.output(), /stopped the robots/);
  // The token is nowhere but in the link that the terminal shows.
  assert.equal(server.output().split(new URL(server.found).searchParams.get('token')).length, 2);
  assert.deepEqual(problems, []);
  await close();
});

test('planted faults are found', async () => {
  const { page, close } = await open(browser, server.found, PHONE);
  await waitForPicture(page);
  await page.evaluate(() => {
    const plant = (html) => document.querySelector('main').insertAdjacentHTML('beforeend', html);
    plant('<p style="width: 400px">wide</p><button style="width: 10px; height: 10px; padding: 0">s</button>');
    plant('<div style="position: relative"><button>under</button><div style="position: absolute; inset: 0"></div></div>');
  });
  const found = (await findings(page)).join('\n');
  for (const what of [/the page is 4\d\d pixels wide/, /too wide: <p/, /<button style.* 10 x \d+/, /<button>under.*covered by <div/]) assert.match(found, what);
  await close();
});

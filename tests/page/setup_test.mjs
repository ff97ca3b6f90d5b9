// The guided setup of the page, with the rehearsal server.
import assert from 'node:assert/strict';
import { readFile, writeFile, mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { axe, hold, launch, open, waitForHalt, waitForLink, waitForPicture } from './browser.mjs';
import { startRehearsal } from './console_server.mjs';
import { act, begin, next, undoCount } from './setup_steps.mjs';

let browser;
before(async () => (browser = await launch()));
after(async () => browser?.close());

/** Every test has a board of its own that nobody has set up yet. */
async function withBoard(run, options = {}, server = {}) {
  const board = await startRehearsal(server);
  try {
    const { page, problems, close } = await open(browser, `${board.url}#setup`, options);
    await run(page, board);
    assert.deepEqual(problems, []);
    await close();
  } finally {
    await board.end();
  }
}
const picture = (page) => page.locator('canvas[data-picture]');

for (const [width, colorScheme] of [[360, 'light'], [768, 'dark'], [1920, 'light']]) {
  test(`the guided way at ${width} pixels: no finding of axe, nothing scrolls sideways, Stop is visible, the next action is one button`, () =>
    withBoard(async (page) => {
      const look = async (name) => {
        // What a step shows arrives with the board's state.
        await page.waitForFunction(() => document.querySelectorAll('main button.primary').length === 1).catch(() => assert.fail(`${name}: one button is the next action`));
        const { scroll, client } = await page.evaluate(() => ({ scroll: document.documentElement.scrollWidth, client: document.documentElement.clientWidth }));
        assert.ok(scroll <= client, `${name}: ${scroll} > ${client}`);
        const stop = await page.locator('header [data-stop]').boundingBox();
        assert.ok(stop && stop.y >= 0 && stop.y + stop.height <= 741, `${name}: Stop is at ${JSON.stringify(stop)}`);
        assert.deepEqual(await axe(page), [], name);
      };
      await look('welcome');
      await begin(page);
      for (const [name, after] of [['camera', 'field'], ['field', 'light'], ['light', 'colors'], ['colors', 'robots']]) {
        await look(name);
        await act(page, name);
        await look(`${name}, done`);
        await next(page, after);
      }
      // Two opponents have the same colors: that is not accepted.
      await page.click('[data-action="robots"]:not([disabled])');
      await page.waitForSelector('[data-setup-error]:has-text("same colors")');
      await page.waitForFunction(() => document.querySelectorAll('[data-top].bad').length === 2);
      await look('robots, refused');
      await page.selectOption('[data-top="opponent-3"] select:not([disabled])', 'cyan');
      await page.waitForFunction(() => document.querySelectorAll('[data-top].bad').length === 0);
      await act(page, 'robots');
      await next(page, 'radio');
      await look('radio');
      await act(page, 'radio');
      await next(page);
      await page.waitForSelector('[data-confirm-save]:not([disabled])');
      await look('save');
      await page.click('[data-confirm-save]');
      await page.waitForSelector('[data-message]:has-text("Saved")');
      await look('saved');
    }, { viewport: { width, height: 740 }, colorScheme }));
}

test('Ctrl+Z undoes, Ctrl+Y does it again, from every step', () =>
  withBoard(async (page) => {
    await begin(page);
    await act(page, 'camera');
    await next(page, 'field');
    await act(page, 'field');
    const before = await undoCount(page);
    await page.keyboard.press('Control+z');
    await page.waitForSelector('[data-goto="field"]:not(.done)');
    await page.waitForFunction((count) => Number(document.querySelector('[data-undo]').dataset.undo) === count - 1, before);
    await page.keyboard.press('Control+y');
    await page.waitForSelector('[data-goto="field"].done');
    await page.click('[data-undo]:not([disabled])');
    await page.waitForSelector('[data-goto="field"]:not(.done)');
    await page.click('[data-redo]:not([disabled])');
    await page.waitForSelector('[data-goto="field"].done');
  }));

test('corners are moved by mouse under a magnifier, and by keyboard', () =>
  withBoard(async (page) => {
    await begin(page);
    await page.click('[data-goto="field"]');
    await act(page, 'field');
    await waitForPicture(page);
    await page.click('[data-by-hand]:not([disabled])');
    const before = await undoCount(page);
    const box = await picture(page).boundingBox();
    const scale = Math.min(box.width / 640, box.height / 480);
    const at = (u, v) => [box.x + box.width / 2 + (u - 319.5) * scale, box.y + box.height / 2 + (v - 239.5) * scale];
    // The rehearsal camera's corner 3: 1.1 m to the right, 0.9 m up.
    const k = 240 * (1 - 0.035 * (1.1 * 1.1 + 0.9 * 0.9));
    const [x, y] = at(319.5 + k * 1.1, 239.5 - k * 0.9);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 30, y + 20, { steps: 4 });
    assert.equal(await page.getAttribute('[aria-label^="Corner 3"]', 'aria-pressed'), 'true');
    await page.mouse.up();
    await page.waitForFunction((count) => Number(document.querySelector('[data-undo]').dataset.undo) === count + 1, before);
    await page.focus('[aria-label^="Corner 2"]');
    await page.keyboard.press('Enter');
    assert.equal(await page.evaluate(() => document.activeElement.tagName), 'CANVAS');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('Shift+ArrowUp');
    await page.waitForFunction((count) => Number(document.querySelector('[data-undo]').dataset.undo) === count + 2, before);
  }));

test('a click on a missing color shows its catch, and is undone with one key', () =>
  withBoard(async (page) => {
    await begin(page);
    await page.click('[data-goto="colors"]');
    await act(page, 'colors');
    await page.waitForSelector('[data-color-chip="yellow"].missing');
    await page.waitForSelector('[data-advice]:has-text("Exchange the red paint")');
    await page.click('[data-color-chip="yellow"]:not([disabled])');
    const magenta = () => page.evaluate(() => {
      const canvas = document.querySelector('canvas[data-picture]');
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) count += data[i] > 250 && data[i + 1] < 5 && data[i + 2] > 250;
      return count;
    });
    assert.equal(await magenta(), 0);
    await picture(page).click({ position: { x: 200, y: 150 } });
    await page.waitForSelector('[data-color-chip="yellow"]:not(.missing)');
    await page.waitForSelector('[data-catch]');
    await page.waitForTimeout(300); // drawn
    assert.ok((await magenta()) > 100);
    await page.keyboard.press('Control+z');
    await page.waitForSelector('[data-color-chip="yellow"].missing');
  }));

test('a setup is exported, and imported on another board', async () => {
  const folder = await mkdtemp(join(tmpdir(), 'touchline-page-'));
  const file = join(folder, 'hall.json');
  try {
    await withBoard(async (page) => {
      await begin(page);
      await act(page, 'camera');
      await page.click('.menu summary');
      const [download] = await Promise.all([page.waitForEvent('download'), page.click('[data-export]:not([disabled])')]);
      await download.saveAs(file);
    });
    assert.ok((await readFile(file, 'utf8')).length > 1000);
    await withBoard(async (page) => {
      await begin(page);
      await page.setInputFiles('[data-file]', file);
      await page.waitForSelector('[data-message]:has-text("hall.json is the draft now")');
      await page.waitForSelector('[data-goto="camera"].done');
      await writeFile(file, 'not a setup');
      await page.setInputFiles('[data-file]', file);
      await page.waitForSelector('[data-setup-error]:has-text("not a setup")');
    });
  } finally {
    await rm(folder, { recursive: true });
  }
});

test('robots stand still while the board is set up, except the one that is driven; stop stops it', () =>
  withBoard(async (page) => {
    await begin(page);
    await page.waitForFunction(() => document.querySelector('[data-halt]').dataset.halt === 'setup');
    await page.click('[data-goto="radio"]');
    await page.click('[data-robot="1"]:not([disabled])');
    await hold(page, () => page.keyboard.down('KeyW'), () => page.keyboard.up('KeyW'), '[data-driving]:has-text("0.20 m/s")');
    await page.keyboard.press('Space');
    await page.waitForSelector('header [data-stop="confirmed"]');
    await waitForHalt(page, true);
    await page.keyboard.up('KeyW');
  }));

test('without a camera, two presses lead to a picture; a camera that is refused says why', () =>
  withBoard(async (page, board) => {
    // The page of a board without camera names what is missing, and offers the cameras that are there.
    await page.waitForSelector('[data-lost="camera"]:has-text("no such device")');
    const chosen = '/dev/v4l/by-id/usb-Rehearsal_Camera-video-index0';
    await page.waitForSelector(`[data-camera="${chosen}"] img[alt]`);
    assert.deepEqual(await axe(page), []);
    assert.equal(await page.locator('canvas[data-picture]').count(), 0);
    assert.match(await page.textContent('[data-camera^="/dev/v4l/by-path"] [data-camera-state]'), /in use by another process/);
    assert.equal(await page.locator('[data-choose-camera]').count(), 1);
    await page.click(`[data-choose-camera="${chosen}"]:not([disabled])`);
    await page.waitForSelector('[data-step="camera"]');
    await waitForPicture(page);
    assert.equal(await undoCount(page), 1);
    assert.equal(await page.inputValue('[data-step="camera"] details input[type="text"]'), chosen);
    // The choice stays open if the step appeared before the status said that the camera is there.
    await page.waitForSelector('[data-lost]', { state: 'detached' });
    if (!(await page.getAttribute('[data-cameras-of-board]', 'open').then((open) => open !== null))) await page.click('[data-cameras-of-board] summary');
    await page.waitForSelector(`[data-camera="${chosen}"] [data-camera-state]:has-text("In use")`);
    assert.deepEqual(await axe(page), []);
    // Looking again asks the board.
    const asked = page.waitForResponse(`${board.url}devices`);
    await page.click('[data-look-again]:not([disabled])');
    assert.equal((await asked).status(), 200);
    await page.waitForSelector('[data-cameras="2"]');
  }, { width: 360 }, { camera: 'false' }));

test('ports are chosen by their lasting names; one that is absent or has a number is pointed out', () =>
  withBoard(async (page) => {
    await begin(page);
    await page.click('[data-goto="radio"]');
    const lasting = '/dev/serial/by-id/usb-Rehearsal_Radio-if00-port0';
    await page.waitForSelector(`[data-port="${lasting}"] input:checked`);
    assert.match(await page.textContent('[data-port="/dev/ttyACM1"]'), /permission denied.*has a number/s);
    assert.match(await page.textContent('[data-gpio-chips]'), /pinctrl-rp1/);
    await page.check('[data-port="/dev/ttyS0"] input:not([disabled])');
    await page.waitForSelector('[data-port="/dev/ttyS0"] input:checked:not([disabled])');
    assert.equal(await undoCount(page), 1);
    assert.deepEqual(await axe(page), []);
  }));

test('nothing is lost when the page is loaded again, and nothing is kept when it is discarded', () =>
  withBoard(async (page) => {
    await begin(page);
    await act(page, 'camera');
    await page.reload();
    await page.waitForSelector('[data-begin]:has-text("go on")');
    await begin(page);
    await page.waitForSelector('[data-step="field"]'); // the first one that is not done
    await page.click('.menu summary');
    await page.click('[data-discard]');
    await page.click('[data-confirm-discard]');
    await page.waitForSelector('[data-message]:has-text("discarded")');
    await page.waitForSelector('[data-begin]:has-text("Start setting up")');
  }));

test('without the setup program the page says what to do', () =>
  withBoard(async (page) => {
    await waitForLink(page, 'Connected');
    await page.waitForSelector('[data-setup-missing]:has-text("systemctl start touchline-setup")');
  }, {}, { setup: 'false' }));

test('who has no control sees the setup but cannot change it', () =>
  withBoard(async (page, board) => {
    await begin(page);
    const other = await open(browser, `${board.url}#setup`);
    await other.page.waitForSelector('[data-begin]:has-text("Take over")');
    await begin(other.page);
    await page.waitForSelector('[data-begin]:has-text("Take over")');
    await other.close();
  }));

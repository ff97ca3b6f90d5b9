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
async function setColor(page, robot, name) {
  const field = page.locator(`[data-top="${robot}"] input[list]:not([disabled])`).first();
  await field.fill(name);
  await field.press('Tab');
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
      const pass = async (name, after) => {
        await look(name);
        await act(page, name);
        await look(`${name}, done`);
        await next(page, after);
      };
      for (const [name, after] of [['camera', 'field'], ['field', 'light'], ['light', 'robots']]) await pass(name, after);
      // Two opponents have the same colors: that is not accepted.
      await page.click('[data-action="robots"]:not([disabled])');
      await page.waitForSelector('[data-setup-error]:has-text("same colors")');
      await page.waitForFunction(() => document.querySelectorAll('[data-top].bad').length === 2);
      await look('robots, refused');
      await setColor(page, 'opponent-3', 'cyan');
      await page.click('[data-edit-layout="own"]');
      await look('robots, layout');
      await page.waitForFunction(() => document.querySelectorAll('[data-top].bad').length === 0);
      await act(page, 'robots');
      await next(page, 'colors');
      await pass('colors', 'radio');
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

// The layout of a window of 1280 x 800 pixels, or of 1366 x 768, with a zoom of 200 %.
for (const [width, height] of [[640, 400], [683, 384]]) {
  test(`at ${width} x ${height} pixels, picture and controls are visible together in every step`, () =>
    withBoard(async (page) => {
      await begin(page);
      for (const name of ['camera', 'field', 'light', 'robots', 'colors', 'radio']) {
        await page.click(`[data-goto="${name}"]`);
        await waitForPicture(page);
        for (const control of [`[data-action="${name}"]`, '[data-next]']) {
          await page.locator(control).scrollIntoViewIfNeeded();
          const [canvas, button, stop, header] = await Promise.all(['canvas[data-picture]', control, 'header [data-stop]', 'header'].map((selector) => page.locator(selector).boundingBox()));
          const below = header.y + header.height;
          const shown = Math.min(canvas.y + canvas.height, height) - Math.max(canvas.y, below);
          assert.ok(shown >= 0.8 * Math.min(canvas.height, height - below), `${name}, ${control}: ${shown} of ${canvas.height} pixels of the picture are visible`);
          assert.ok(canvas.width > 250, `${name}: the picture is ${canvas.width} pixels wide`);
          assert.ok(button.y >= below - 1 && button.y + button.height <= height + 1, `${name}, ${control}: ${JSON.stringify(button)}`);
          assert.ok(stop.y >= 0 && stop.y + stop.height <= height, 'Stop is visible');
        }
      }
      assert.deepEqual(await axe(page), []);
    }, { viewport: { width, height } }));
}

test('at 1920 pixels no large part of a step is empty', () =>
  withBoard(async (page) => {
    await page.waitForSelector('[data-begin]');
    const widths = async (name, least) => {
      const right = await page.evaluate(() => Math.max(...[...document.querySelectorAll('main .panel')].map((panel) => panel.getBoundingClientRect().right)));
      assert.ok(right > least, `${name} ends at ${right}`);
    };
    await widths('welcome', 1850);
    await begin(page);
    for (const name of ['camera', 'field', 'light', 'robots', 'colors', 'radio']) {
      await page.click(`[data-goto="${name}"]`);
      await waitForPicture(page);
      await widths(name, 1850);
      const { y, height } = await page.locator('canvas[data-picture]').boundingBox();
      assert.ok(y < 300 && height > 400, `${name}: the picture is at ${y} and ${height} pixels high`);
    }
  }, { viewport: { width: 1920, height: 1080 } }));

test('the menu closes on Escape and when something else is pressed', () =>
  withBoard(async (page) => {
    await begin(page);
    const open = () => page.waitForSelector('.menu[open]');
    const closed = () => page.waitForSelector('.menu:not([open])');
    await page.click('.menu summary');
    await open();
    await page.keyboard.press('Escape');
    await closed();
    assert.equal(await page.evaluate(() => document.activeElement.tagName), 'SUMMARY');
    await page.keyboard.press('Enter');
    await open();
    await page.click('canvas[data-picture]', { position: { x: 20, y: 200 } });
    await closed();
    await page.click('.menu summary');
    await open();
    await page.focus('[data-save]');
    await closed();
  }));

test('a layout is drawn while it is typed, and used when the person says so', () =>
  withBoard(async (page) => {
    await begin(page);
    await page.click('[data-goto="robots"]');
    await page.click('[data-edit-layout="own"]');
    const drawn = () => page.getAttribute('[data-top="own-0"] polygon', 'points');
    const before = await drawn();
    const steps = await undoCount(page);
    await page.fill('[data-patch="0-x_m"]', '5');
    assert.notEqual(await drawn(), before);
    assert.equal(await undoCount(page), steps, 'nothing is sent while somebody types');
    await page.click('[data-use-layout]:not([disabled])');
    await page.waitForFunction((count) => Number(document.querySelector('[data-undo]').dataset.undo) === count + 1, steps);
    await page.waitForFunction(() => document.querySelector('[data-layout="own"]').value === 'own-two-squares');
    assert.equal(await page.inputValue('[data-patch="0-x_m"]'), '5');
    // Any name of a color.
    await setColor(page, 'own-1', 'our paint');
    await page.waitForFunction(() => document.querySelector('[data-top="own-1"] svg').getAttribute('aria-label').includes('our paint'));
    await setColor(page, 'opponent-1', 'their paint');
    await page.waitForFunction(() => document.querySelector('[data-top="opponent-1"] svg').getAttribute('aria-label').includes('their paint'));
    // Only colors that robots have are asked for.
    await page.click('[data-goto="colors"]');
    await page.waitForSelector('[data-color-chip="our paint"]');
    assert.equal(await page.locator('[data-color-chip="green"]').count(), 0);
  }));

test('a color is clicked on with the keyboard alone', () =>
  withBoard(async (page) => {
    await begin(page);
    await page.click('[data-goto="colors"]');
    await act(page, 'colors');
    await page.focus('[data-color-chip="yellow"]:not([disabled])');
    await page.keyboard.press('Enter');
    await page.waitForSelector('[data-color-chip="yellow"][aria-pressed="true"]');
    await page.focus('canvas[data-picture]');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('Shift+ArrowLeft');
    const [u, v] = (await page.getAttribute('canvas[data-picture]', 'data-cross')).split(' ').map(Number);
    assert.ok(u < 310 && u > 100 && Math.abs(v - 240) < 3, `the crosshair is at ${u}, ${v}`);
    await page.keyboard.press('Enter');
    await page.waitForSelector('[data-color-chip="yellow"]:not(.missing)');
  }));

test('the whole way with the keyboard alone, from the start to the files', () =>
  withBoard(async (page) => {
    await page.evaluate(() => addEventListener('pointerdown', () => (window.pressed = true), true));
    /** Moves the focus with Tab until it is on an element that matches. */
    const reach = async (selector) => {
      await page.waitForSelector(selector);
      for (let i = 0; i < 250; i += 1) {
        if (await page.evaluate((wanted) => document.activeElement.matches(wanted), selector)) return;
        await page.keyboard.press('Tab');
      }
      assert.fail(`Tab does not reach ${selector}`);
    };
    const press = async (selector) => {
      await reach(`${selector}:not([disabled])`);
      await page.keyboard.press('Enter');
    };
    const pass = async (step) => {
      await press(`[data-action="${step}"]`);
      await page.waitForSelector(`[data-goto="${step}"].done`);
    };
    const goOn = async (step) => {
      await press('[data-next]');
      await page.waitForSelector(`[data-step="${step}"]`);
    };
    await press('[data-begin]');
    await page.waitForSelector('[data-step="camera"]');
    await pass('camera');
    await goOn('field');
    await reach('[data-preset]:not([disabled])');
    const preset = await page.inputValue('[data-preset]');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowUp');
    assert.equal(await page.inputValue('[data-preset]'), preset);
    await reach('[data-height]:not([disabled])');
    await page.keyboard.type('2.3');
    await page.keyboard.press('Tab');
    await pass('field');
    await goOn('light');
    await pass('light');
    await goOn('robots');
    await reach('[data-top="opponent-3"] input[list]:not([disabled])');
    await page.keyboard.press('Control+a');
    await page.keyboard.type('cyan');
    await page.keyboard.press('Tab');
    await pass('robots');
    await goOn('colors');
    await pass('colors');
    await press('[data-color-chip="yellow"]');
    await reach('canvas[data-picture]');
    await page.keyboard.press('Shift+ArrowLeft');
    await page.keyboard.press('Enter');
    await page.waitForSelector('[data-color-chip="yellow"]:not(.missing)');
    await goOn('radio');
    await press('[data-robot="1"]');
    await hold(page, () => page.keyboard.down('KeyW'), () => page.keyboard.up('KeyW'), '[data-driving]:has-text("0.20 m/s")');
    await page.keyboard.up('KeyW');
    await pass('radio');
    await press('[data-next]');
    await page.waitForSelector('[data-save-panel]');
    await press('[data-confirm-save]');
    await page.waitForSelector('[data-message]:has-text("Saved")');
    assert.equal(await page.evaluate(() => window.pressed), undefined, 'no pointer was used');
  }));

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
    assert.match(await page.textContent('[data-camera^="/dev/v4l/by-path"] [data-camera-state]'), /in use by guvcview \(process 1234\)/);
    assert.deepEqual(await page.$$eval('[data-no-picture]', (all) => all.map(({ textContent }) => textContent)), ['In use by guvcview (process 1234)', 'Does not answer']);
    assert.equal(await page.locator('[data-choose-camera]').count(), 2, 'the other one is a camera of libcamera');
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
    await page.waitForSelector('[data-cameras="4"]');
  }, { viewport: { width: 360, height: 740 } }, { camera: 'false' }));

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

// The setup of a copy of the arena TOUCHLINE_BOARD, with the real programs TOUCHLINE_PROGRAM and TOUCHLINE_SETUP.
import assert from 'node:assert/strict';
import { cp, mkdtemp, readFile, readdir, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { launch, open } from './browser.mjs';
import { startProgram, startSetup } from './console_server.mjs';
import { begin } from './setup_steps.mjs';

const { TOUCHLINE_PROGRAM: program, TOUCHLINE_SETUP: setupProgram, TOUCHLINE_BOARD: original } = process.env;

let browser;
before(async () => (browser = await launch()));
after(async () => browser?.close());

/** Both programs with a copy of the board's folder. */
async function withArena(run) {
  const folder = await mkdtemp(join(tmpdir(), 'touchline-arena-'));
  let setup;
  let server;
  try {
    for (const name of await readdir(dirname(original))) if (/\.(toml|png)$/.test(name)) await cp(join(dirname(original), name), join(folder, name));
    const board = join(folder, basename(original));
    const socket = join(folder, 'setup.sock');
    setup = await startSetup(setupProgram, board, join(folder, 'state'), socket);
    server = await startProgram(program, board, 0, ['--set', `console.setup_socket=${socket}`]);
    const { page, problems, close } = await open(browser, `${server.url}#setup`);
    await run(page, folder);
    assert.deepEqual(problems, []);
    await close();
  } finally {
    await server?.end();
    await setup?.end();
    await rm(folder, { recursive: true, force: true });
  }
}

test('the field is found, undone with one key, and saved after its difference was shown', () =>
  withArena(async (page, folder) => {
    const venue = () => readFile(join(folder, 'venue.toml'), 'utf8');
    const before = await venue();
    await begin(page);
    await page.click('[data-goto="field"]');
    await page.selectOption('[data-preset]:not([disabled])', 'mirosot-middle');
    await page.fill('[data-height]', '2.3');
    await page.click('[data-action="field"]:not([disabled])');
    await page.waitForSelector('[data-error-map]');
    await page.waitForSelector('[data-quality="ok"]:has-text("mm")');
    await page.focus('#main');
    await page.keyboard.press('Control+z');
    await page.waitForSelector('[data-undo="0"]');
    await page.waitForSelector('[data-error-map]', { state: 'detached' });
    await page.keyboard.press('Control+y');
    await page.waitForSelector('[data-error-map]');

    await page.click('[data-save]');
    await page.waitForSelector('[data-save-panel] .added:has-text("line_width_m")');
    assert.equal(await venue(), before, 'nothing is written before the differences were shown');
    await page.click('[data-confirm-save]:not([disabled])');
    await page.waitForSelector('[data-message]:has-text("Saved")');
    const after = await venue();
    assert.ok(after !== before && after.includes('line_width_m') && after.includes('[camera_model.full]'));
    assert.equal(await readFile(join(folder, 'venue.toml.bak'), 'utf8'), before);
    await page.waitForSelector('[data-begin]');
  }));

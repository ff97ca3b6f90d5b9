// Screenshots of every step of the setup, with rehearsal servers: node dev/look_setup.js FOLDER [light,dark] [360,768,1920]
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const [folder, themes = 'light,dark', widths = '360,768,1920'] = process.argv.slice(2);
const heights = { 360: 740, 768: 1024, 1920: 1080 };
mkdirSync(folder, { recursive: true });
/** A server that nobody has set up yet. */
async function serve() {
  const child = spawn(process.execPath, [fileURLToPath(new URL('server.js', import.meta.url)), '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const [line] = await once(child.stdout, 'data');
  return { url: /http:\S+/.exec(line.toString())[0], end: () => child.kill() };
}
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });
for (const theme of themes.split(',')) {
  for (const width of widths.split(',').map(Number)) {
    const { url, end } = await serve();
    const context = await browser.newContext({ viewport: { width, height: heights[width] ?? 900 }, colorScheme: theme, hasTouch: width < 1000 });
    const page = await context.newPage();
    page.setDefaultTimeout(20000);
    page.on('pageerror', (error) => console.log('error', error.message));
    page.on('console', (message) => message.type() === 'error' && console.log('console', message.text()));
    const shot = async (name) => {
      await page.waitForTimeout(700);
      await page.screenshot({ path: `${folder}/${name}-${theme}-${width}.png`, fullPage: width < 1000 });
    };
    const act = async (step) => {
      await page.click(`[data-action="${step}"]:not([disabled])`);
      await page.waitForSelector(`[data-goto="${step}"].done`);
    };
    await page.goto(`${url}#setup`);
    await page.waitForSelector('[data-begin]');
    await shot('0-welcome');
    await page.click('[data-begin]');
    await page.waitForSelector('[data-step="camera"]');
    await page.waitForSelector('svg');
    await shot('1-camera');
    await act('camera');
    await page.click('[data-next]');
    await shot('2-field-before');
    await act('field');
    await shot('2-field');
    await page.click('[data-by-hand]');
    await page.click('[aria-label^="Corner 2"]');
    await shot('2-field-corners');
    await page.click('[data-next]');
    await act('light');
    await shot('3-light');
    await page.click('[data-next]');
    await shot('4-robots');
    await page.click('[data-action="robots"]');
    await page.waitForSelector('[data-setup-error]');
    await shot('4-robots-error');
    await page.fill('[data-top="opponent-3"] input[list]', 'cyan');
    await page.keyboard.press('Tab');
    await page.waitForSelector('[data-quality="warning"]');
    await act('robots');
    await page.click('[data-next]');
    await page.click('[data-action="colors"]');
    await page.waitForTimeout(500);
    await shot('5-colors-busy');
    await page.waitForSelector('[data-goto="colors"].done');
    await page.click('[data-color-chip="yellow"]:not([disabled])');
    await page.locator('canvas[data-picture]').click({ position: { x: 100, y: 80 } });
    await page.waitForSelector('[data-catch]');
    await shot('5-colors');
    await page.click('[data-next]');
    await page.click('[data-robot="1"]:not([disabled])');
    await shot('6-radio');
    await act('radio');
    await page.click('[data-next]');
    await page.waitForSelector('[data-confirm-save]:not([disabled])');
    await shot('7-save');
    await page.click('.menu summary');
    await shot('8-menu');
    await page.click('.menu summary');
    await page.click('[data-confirm-save]');
    await page.waitForSelector('[data-message]');
    await shot('9-saved');
    await context.close();
    end();
  }
}
await browser.close();

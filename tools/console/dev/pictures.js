// The pictures of docs/console.md, of a running console, if possible with touchline-setup: node dev/pictures.js URL
import { chromium } from 'playwright-core';

const url = process.argv[2];
const docs = new URL('../../../docs/', import.meta.url).pathname;
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });

async function open(width, height, options = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: 'light', ...options });
  const page = await context.newPage();
  await page.goto(url);
  await page.waitForFunction(() => document.querySelector('canvas[data-picture]')?.dataset.picture);
  return page;
}
const save = (page, name) => page.screenshot({ path: `${docs}console-${name}.jpg`, type: 'jpeg', quality: 82 });
const show = async (page, name) => {
  await page.click(`nav a[href="#${name}"]`);
  await page.waitForTimeout(3000); // trails
};

const page = await open(1280, 800);
await page.click('[data-layer="trails"]');
const box = await page.locator('canvas[data-picture]').boundingBox();
await page.mouse.move(box.x + 0.35 * box.width, box.y + 0.4 * box.height);
await page.waitForTimeout(4000);
await save(page, 'live');
await show(page, 'timing');
await save(page, 'timing');
await show(page, 'play');
await page.click('button:text-is("Take control")');
await page.click('[data-robot="2"]');
await page.keyboard.down('KeyW');
await page.waitForTimeout(700);
await save(page, 'play');
await page.keyboard.up('KeyW');
const phone = await open(360, 700, { isMobile: true, hasTouch: true });
await phone.waitForTimeout(2000);
await phone.tap('header [data-stop]');
await phone.waitForSelector('header [data-stop="confirmed"]');
await phone.waitForTimeout(500);
await save(phone, 'phone');
await page.click('[data-start]');
await page.click('button:text-is("Give up control")');
// With touchline-setup beside the firmware.
await page.click('nav a[href="#setup"]');
if (await page.waitForSelector('[data-begin]', { timeout: 5000 }).catch(() => null)) {
  await page.click('[data-begin]:not([disabled])');
  await page.click('[data-goto="field"]');
  await page.click('[data-action="field"]:not([disabled])');
  await page.waitForSelector('[data-error-map]');
  await page.waitForTimeout(1000);
  await save(page, 'setup');
  await page.click('.menu summary');
  await page.click('[data-discard]:not([disabled])');
  await page.click('[data-confirm-discard]');
  await page.waitForSelector('[data-begin]');
}
await browser.close();

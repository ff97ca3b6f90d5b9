// Screenshots of every page: node dev/look.js URL FOLDER [light,dark] [360,768,1280,1920] [live,play,recordings,timing,setup]
import { mkdirSync } from 'node:fs';
import { chromium } from 'playwright-core';

const [url, folder, themes = 'light,dark', widths = '360,768,1280,1920', pages = 'live,play,recordings,timing,setup'] = process.argv.slice(2);
const heights = { 360: 740, 768: 1024, 1280: 800, 1920: 1080 };
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });
for (const theme of themes.split(',')) {
  for (const width of widths.split(',').map(Number)) {
    const context = await browser.newContext({ viewport: { width, height: heights[width] ?? 900 }, colorScheme: theme, hasTouch: width < 1000 });
    const page = await context.newPage();
    page.on('pageerror', (error) => console.log('error', error.message));
    page.on('console', (message) => message.type() === 'error' && console.log('console', message.text()));
    await page.goto(url);
    for (const name of pages.split(',')) {
      await page.evaluate((hash) => (location.hash = hash), name);
      await page.waitForTimeout(2500);
      await page.screenshot({ path: `${folder}/${name}-${theme}-${width}.png`, fullPage: width < 1000 });
    }
    await context.close();
  }
}
await browser.close();

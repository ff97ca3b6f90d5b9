// The page in Chromium. Nothing here depends on how fast the machine is: every wait has the limit of a minute.
import { createRequire } from 'node:module';

const require = createRequire(new URL('../../tools/console/package.json', import.meta.url));
const { chromium } = require('playwright-core');
const axeSource = require('axe-core').source;

export const PAGES = ['live', 'play', 'recordings', 'timing', 'setup'];
export const PATIENCE_MS = Number(process.env.PATIENCE_MS ?? 60_000);

export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });

/** Opens the page; `problems` collects everything that a developer would see in red, and requests to other hosts. */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, bypassCSP: false, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const problems = [];
  page.on('pageerror', (error) => problems.push(`error: ${error.message}`));
  page.on('console', (message) => message.type() === 'error' && problems.push(`console: ${message.text()}`));
  page.on('request', (request) => {
    const { protocol, host } = new URL(request.url());
    if (!['blob:', 'data:'].includes(protocol) && host !== new URL(url).host) problems.push(`request to ${host}`);
  });
  await page.goto(url);
  return { page, problems, close: () => context.close() };
}

export const show = async (page, name) => {
  await page.click(`nav a[href="#${name}"]`);
  await page.waitForSelector(`nav a[href="#${name}"][aria-current="page"]`);
};

export const waitForLink = (page, word) => page.waitForSelector(`[data-link="${word}"]`);

/** Until the header shows, or no longer shows, the halt, by a state that is not old. */
export const waitForHalt = (page, halted, timeout = PATIENCE_MS) =>
  page.waitForFunction((wanted) => document.querySelector('[data-link="Connected"]') && document.querySelector('[data-halt]').dataset.halt.split(' ').includes('console') === wanted, halted, { timeout });

export const waitForPicture = (page) => page.waitForFunction(() => document.querySelector('canvas[data-picture]')?.dataset.picture);

/** Ids of axe's findings that are serious or critical, with the elements. */
export async function axe(page) {
  // Not as a script of the page: its Content-Security-Policy forbids that.
  if (!(await page.evaluate(() => 'axe' in window))) await page.evaluate(axeSource);
  const result = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
  return result.violations
    .filter(({ impact }) => impact === 'serious' || impact === 'critical')
    .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(' ')).join(', ')}`);
}

/**
 * Presses something that drives until `shown` is visible. A page that gets no processor for a second loses the robot, and
 * rightly so; it is then pressed anew.
 */
export async function hold(page, press, release, shown) {
  for (let attempt = 1; ; ++attempt) {
    await press();
    const found = await page.waitForSelector(shown, { timeout: 5000 }).catch((error) => {
      if (attempt === 8) throw error;
    });
    if (found) return;
    await release();
  }
}

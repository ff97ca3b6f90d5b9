// What a person does on the page "Set up".
import { PATIENCE_MS } from './browser.mjs';

// A quarter of the patience, because a press is repeated four times.
const SHOWN_MS = PATIENCE_MS / 4;

/** Takes control and opens a draft, or goes on with one. */
export async function begin(page) {
  await page.click('[data-begin]:not([disabled])');
  await page.waitForSelector('[data-step]');
}

/**
 * Presses the big button of a step that is shown, and waits until it is done. What arrives meanwhile may move the button away from under
 * the pointer, so a press that nothing follows is repeated.
 */
export async function act(page, step) {
  for (let attempt = 1; ; attempt += 1) {
    await page.click(`[data-action="${step}"]:not([disabled])`);
    if (await page.waitForSelector(`[data-goto="${step}"].done`, { timeout: SHOWN_MS }).catch(() => null)) break;
    if (await page.locator(`[data-action="${step}"][disabled]`).count()) {
      await page.waitForSelector(`[data-goto="${step}"].done`); // a slow board still works
      break;
    }
    if (attempt === 4) throw new Error(`the step ${step} is not done: ${await page.textContent(`[data-step="${step}"]`)}`);
  }
  await page.waitForSelector(`[data-action="${step}"]:not([disabled])`);
}

/** Goes on to the step `name`, or to the differences. Results that arrive meanwhile may move the button away from under the pointer. */
export async function next(page, name) {
  const shown = name ? `[data-step="${name}"]` : '[data-save-panel]';
  for (let attempt = 0; attempt < 5; attempt += 1) {
    await page.click('[data-next]');
    if (await page.waitForSelector(shown, { timeout: Math.max(5000, SHOWN_MS / 3) }).catch(() => null)) return;
  }
  throw new Error(`${shown} does not appear`);
}

export const undoCount = async (page) => Number(await page.getAttribute('[data-undo]', 'data-undo'));

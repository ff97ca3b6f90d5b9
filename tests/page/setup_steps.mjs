// What a person does on the page "Set up".

/** Takes control and opens a draft, or goes on with one. */
export async function begin(page) {
  await page.click('[data-begin]:not([disabled])');
  await page.waitForSelector('[data-step]');
}

/** Presses the big button of a step that is shown, and waits until it is done. */
export async function act(page, step) {
  await page.click(`[data-action="${step}"]:not([disabled])`);
  await page.waitForSelector(`[data-goto="${step}"].done`);
  await page.waitForSelector(`[data-action="${step}"]:not([disabled])`);
}

export const next = (page) => page.click('[data-next]');

export const undoCount = async (page) => Number(await page.getAttribute('[data-undo]', 'data-undo'));

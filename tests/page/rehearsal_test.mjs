// The page with the rehearsal server: looks, access, and what the real program shows rarely.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { axe, hold, launch, open, PAGES, show, waitForHalt, waitForLink, waitForPicture } from './browser.mjs';
import { startRehearsal } from './console_server.mjs';

let browser;
let server;
before(async () => {
  browser = await launch();
  server = await startRehearsal();
});
after(async () => {
  await browser?.close();
  await server?.end();
});

/** With another server than the common one. */
async function withServer(options, run) {
  const other = await startRehearsal(options);
  try {
    const opened = await open(browser, other.url);
    await run(opened.page, opened.problems, other);
    await opened.close();
  } finally {
    await other.end();
  }
}

// 640 x 400: a window of 1280 x 800 with a zoom of 200 %.
for (const [width, height] of [[360, 740], [640, 400], [768, 740], [1280, 740], [1920, 740]]) {
  test(`no page scrolls sideways at ${width} x ${height} pixels, Stop is visible, and axe has no serious findings`, async () => {
    const { page, close } = await open(browser, server.url, { viewport: { width, height } });
    await waitForLink(page, 'Connected');
    for (const name of PAGES) {
      await show(page, name);
      await page.waitForTimeout(300); // charts are drawn
      const { scroll, client } = await page.evaluate(() => ({ scroll: document.documentElement.scrollWidth, client: document.documentElement.clientWidth }));
      assert.ok(scroll <= client, `${name}: ${scroll} > ${client}`);
      await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
      const stop = await page.locator('header [data-stop]').boundingBox();
      assert.ok(stop && stop.y >= 0 && stop.y + stop.height <= height + 1 && stop.height >= 44, `${name}: Stop is at ${JSON.stringify(stop)}`);
      assert.deepEqual(await axe(page), [], name);
    }
    await close();
  });
}

for (const colorScheme of ['light', 'dark']) {
  test(`axe has no serious findings in ${colorScheme} colors`, async () => {
    const { page, close } = await open(browser, server.url, { colorScheme });
    await waitForLink(page, 'Connected');
    for (const name of PAGES) {
      await show(page, name);
      assert.deepEqual(await axe(page), [], name);
    }
    await page.keyboard.press('Space');
    await page.waitForSelector('header [data-stop="confirmed"]');
    await show(page, 'play');
    assert.deepEqual(await axe(page), [], 'stopped');
    await page.click('button:text-is("Take control")');
    await page.click('[data-start]:not([disabled])');
    await waitForHalt(page, false);
    assert.deepEqual(await axe(page), [], 'with control');
    await page.click('button:text-is("Give up control")');
    await close();
  });
}

test('axe finds a planted fault', async () => {
  const { page, close } = await open(browser, server.url);
  await page.evaluate(() => document.querySelector('main').insertAdjacentHTML('beforeend', '<button></button><p style="color:#bbb;background:#fff">faint</p>'));
  const findings = await axe(page);
  assert.ok(findings.some((text) => text.startsWith('button-name')) && findings.some((text) => text.startsWith('color-contrast')), findings.join('\n'));
  await close();
});

test('everything is reached by keyboard, and the focus shows', async () => {
  const { page, close } = await open(browser, server.url);
  await waitForPicture(page);
  const reached = new Set();
  for (let i = 0; i < 40; i += 1) {
    await page.keyboard.press('Tab');
    const focus = await page.evaluate(() => {
      const element = document.activeElement;
      return { name: element.textContent.trim().split(/\s+/)[0] || element.tagName, outline: getComputedStyle(element).outlineStyle, body: element === document.body };
    });
    if (focus.body) break;
    assert.notEqual(focus.outline, 'none', `${focus.name} shows no focus`);
    reached.add(focus.name);
  }
  for (const name of ['Skip', 'Stop', 'Live', 'Play', 'Timing', 'Set', 'Dark', 'Robots', 'CANVAS', '+']) assert.ok(reached.has(name), `${name} is not among ${[...reached]}`);
  await page.focus('[data-layer="trails"]');
  await page.keyboard.press('Enter');
  assert.equal(await page.getAttribute('[data-layer="trails"]', 'aria-pressed'), 'true');
  // The space bar stops also when a button has the focus, and does not press it.
  await page.keyboard.press('Space');
  await page.waitForSelector('header [data-stop="confirmed"]');
  assert.equal(await page.getAttribute('[data-layer="trails"]', 'aria-pressed'), 'true');
  await close();
});

test('light and dark follow the system until they are chosen', async () => {
  const { page, close } = await open(browser, server.url, { colorScheme: 'dark' });
  const themeOf = () => page.evaluate(() => document.documentElement.dataset.theme);
  assert.equal(await themeOf(), 'dark');
  await page.emulateMedia({ colorScheme: 'light' });
  await page.waitForFunction(() => document.documentElement.dataset.theme === 'light');
  await page.click('nav button');
  await page.waitForFunction(() => document.documentElement.dataset.theme === 'dark');
  await page.reload();
  assert.equal(await themeOf(), 'dark');
  await close();
});

test('a server of another protocol: nothing of it is shown, and the page offers to load again', () =>
  withServer({ protocol: '2' }, async (page) => {
    await page.waitForSelector('[data-notice="protocol"] button');
    await waitForLink(page, 'Other version');
    assert.equal(await page.locator('canvas').count(), 0);
  }));

test('a server that was replaced: the page offers to load again', () =>
  withServer({ version: 'first' }, async (page, _, other) => {
    await waitForLink(page, 'Connected');
    await other.end();
    await waitForLink(page, 'No connection');
    const next = await startRehearsal({ version: 'second' }, other.port);
    await page.waitForSelector('[data-notice="version"]:has-text("second")');
    await next.end();
  }));

test('page and server of different versions: the page says so, and goes on', () =>
  withServer({ version: '9.9.9' }, async (page) => {
    await waitForLink(page, 'Connected');
    await page.waitForSelector('[data-notice="other-version"]:has-text("9.9.9")');
    await waitForPicture(page);
  }));

test('the adaptation to the light is frozen, followed and reset by who has control', () =>
  withServer({}, async (page) => {
    await page.waitForSelector('[data-adaptation="follow"]');
    assert.ok(await page.isDisabled('button:text-is("Freeze")'));
    await show(page, 'play');
    await page.click('button:text-is("Take control")');
    await show(page, 'live');
    await page.click('button:text-is("Freeze"):not([disabled])');
    await page.waitForSelector('[data-adaptation="frozen"]');
    await page.click('button:text-is("Follow"):not([disabled])');
    await page.waitForSelector('[data-adaptation="follow"]');
    await page.click('button:text-is("Reset"):not([disabled])');
    await page.waitForSelector('[data-adaptation="off"]');
  }));

test('text of files is text', () => {
  const text = '<script>window.hacked = 1</script><img src=x onerror="window.hacked = 1">';
  const robots = [{ team: 'own', id: 0, name: text, color: text, rgb: [1, 2, 3] }];
  return withServer({ hello: { board: text, venue: text, team: text, robots, camera: { width_px: 640, height_px: 480, rate_hz: 60, description: text } } }, async (page, problems) => {
    await waitForLink(page, 'Connected');
    for (const name of PAGES) await show(page, name);
    await show(page, 'play');
    assert.ok((await page.textContent('table')).includes(text));
    assert.equal(await page.evaluate(() => window.hacked), undefined);
    assert.equal(await page.locator('header img, main img').count(), 0);
    assert.deepEqual(problems, []);
  });
});

test('the clock of this device does not matter, and its difference is said', () =>
  withServer({ hello: { time_s: Date.now() / 1000 - 7200 } }, async (page) => {
    await waitForPicture(page);
    assert.equal(await page.locator('canvas.stale').count(), 0);
    await show(page, 'timing');
    assert.match(await page.textContent('[data-clock]'), /differ by (1 h 59|2 h 0) min/);
  }));

test('a robot is driven while the pad is held, and stands when the window loses the focus', () =>
  withServer({}, async (page) => {
    await show(page, 'play');
    await page.click('button:text-is("Take control")');
    await page.click('[data-robot="1"]:not([disabled])');
    const driving = (text) => page.waitForFunction((wanted) => document.querySelector('[data-driving]').textContent.includes(wanted), text);
    const pad = page.locator('.pad');
    await pad.scrollIntoViewIfNeeded();
    const box = await pad.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + 1);
    await hold(page, () => page.mouse.down(), () => page.mouse.up(), 'tr[data-own="1"] >> text=this console');
    await driving('0.20 m/s, 0.0 rad/s');
    await page.mouse.up();
    await driving('0.00 m/s');
    await page.keyboard.down('ArrowUp');
    await driving('0.20 m/s');
    await page.evaluate(() => window.dispatchEvent(new Event('blur')));
    await driving('0.00 m/s');
  }));

test('a board that refuses access says how to get it', () =>
  withServer({}, async (page, _, other) => {
    await waitForLink(page, 'Connected');
    await page.route(other.url, (route) => (route.request().method() === 'HEAD' ? route.fulfill({ status: 401 }) : route.continue()));
    await other.end();
    await page.waitForSelector('[data-notice="lost"] >> text=The board refuses access.');
  }));

test('axe has no serious findings without a connection', () =>
  withServer({}, async (page, _, other) => {
    await waitForLink(page, 'Connected');
    await show(page, 'timing');
    await page.waitForSelector('.chart canvas');
    await other.end();
    await waitForLink(page, 'No connection');
    for (const name of PAGES) {
      await show(page, name);
      assert.deepEqual(await axe(page), [], name);
    }
  }));

test('a stop without a connection is not shown as done, and is sent when the link is back', () =>
  withServer({}, async (page, _, other) => {
    await waitForLink(page, 'Connected');
    await other.end();
    await waitForLink(page, 'No connection');
    await page.keyboard.press('Space');
    await page.waitForSelector('[data-notice="late-stop"]');
    assert.equal(await page.locator('[data-stop="confirmed"]').count(), 0);
    const next = await startRehearsal({}, other.port);
    await page.waitForSelector('header [data-stop="confirmed"]');
    await next.end();
  }));

// How long the page waits for an answer of the setup program.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { ANSWER_MS, whenSilent } from '../../../tools/console/src/lib/silence';

/** Runs `body` with timers that only `pass` moves. */
function withTimers(body: (pass: (ms: number) => void, now: () => number) => void): void {
  const { setInterval: real, clearInterval: end } = globalThis;
  const timers = new Map<number, { every: number; next: number; run: () => void }>();
  let time = 0;
  globalThis.setInterval = ((run: () => void, every: number) => {
    const id = timers.size + 1;
    timers.set(id, { every, next: time + every, run });
    return id;
  }) as unknown as typeof setInterval;
  globalThis.clearInterval = ((id: number) => timers.delete(id)) as unknown as typeof clearInterval;
  const pass = (ms: number) => {
    for (const until = time + ms; time < until; ) {
      time += 100;
      for (const timer of [...timers.values()]) {
        if (timer.next > time) continue;
        timer.next += timer.every;
        timer.run();
      }
    }
  };
  try {
    body(pass, () => time);
  } finally {
    globalThis.setInterval = real;
    globalThis.clearInterval = end;
  }
}

test('25 s without an answer are reported once', () => {
  withTimers((pass, now) => {
    let reports = 0;
    whenSilent(() => false, () => (reports += 1), now);
    pass(24_900);
    assert.equal(reports, 0);
    pass(1100);
    assert.equal(reports, 1);
    pass(10 * ANSWER_MS);
    assert.equal(reports, 1);
  });
});

test('a busy setup program is not silent, and neither is one that has answered', () => {
  withTimers((pass, now) => {
    let busy = true;
    let reports = 0;
    whenSilent(() => busy, () => (reports += 1), now);
    pass(4 * ANSWER_MS);
    assert.equal(reports, 0);
    busy = false;
    pass(ANSWER_MS - 1000);
    assert.equal(reports, 0);
    pass(2000);
    assert.equal(reports, 1);
    const answered = whenSilent(() => false, () => (reports += 1), now);
    pass(1000);
    answered();
    pass(2 * ANSWER_MS);
    assert.equal(reports, 1);
  });
});

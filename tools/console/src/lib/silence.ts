// The setup program answers within a moment, or says that it is busy; it waits at most 20 s for a picture of the camera.
export const ANSWER_MS = 25_000;
const LOOK_MS = 1000;

/** Calls `silent` once, when `isBusy` has been false for ANSWER_MS. Returns a function that ends the watch. */
export function whenSilent(isBusy: () => boolean, silent: () => void, now = () => performance.now()): () => void {
  let busyAt = now();
  const watch = setInterval(() => {
    if (isBusy()) busyAt = now();
    if (now() - busyAt < ANSWER_MS) return;
    clearInterval(watch);
    silent();
  }, LOOK_MS);
  return () => clearInterval(watch);
}

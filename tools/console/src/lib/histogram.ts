import type { LatencySummary } from './protocol';

/** Shares of both distributions in the same bins of equal width; `edges_ms` are the lower edges. */
export interface SharedHistogram {
  width_ms: number;
  edges_ms: number[];
  start_percent: (number | null)[];
  minute_percent: (number | null)[];
}

const MAX_BINS = 40;
const WIDTHS_MS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];

/** Spreads the server's bins over bins of a round width, so that both fit one chart. Empty bins are null. */
export function sharedHistogram(start: LatencySummary, minute: LatencySummary): SharedHistogram {
  const bins = [...start.bins, ...minute.bins];
  if (bins.length === 0) return { width_ms: 1, edges_ms: [], start_percent: [], minute_percent: [] };
  const low = Math.min(...bins.map(([from]) => from));
  const high = Math.max(...bins.map(([, to]) => to));
  const width_ms = WIDTHS_MS.find((width) => (high - low) / width <= MAX_BINS) ?? (high - low) / MAX_BINS;
  const first = Math.floor(low / width_ms);
  const length = Math.max(1, Math.ceil(high / width_ms) - first);
  const percent = (summary: LatencySummary): (number | null)[] => {
    const shares = new Array<number>(length).fill(0);
    const total = summary.bins.reduce((sum, [, , n]) => sum + n, 0);
    for (const [from, to, n] of summary.bins) {
      const begin = Math.max(0, Math.floor(from / width_ms) - first);
      const end = Math.min(length - 1, Math.max(begin, Math.ceil(to / width_ms) - first - 1));
      for (let i = begin; i <= end; i += 1) {
        const overlap = Math.min(to, (first + i + 1) * width_ms) - Math.max(from, (first + i) * width_ms);
        const share = to > from ? Math.max(0, overlap) / (to - from) : 1 / (end - begin + 1);
        shares[i] = (shares[i] ?? 0) + (100 * n * share) / total;
      }
    }
    return shares.map((share) => (share > 0 ? share : null));
  };
  return {
    width_ms,
    edges_ms: Array.from({ length }, (_, i) => (first + i) * width_ms),
    start_percent: percent(start),
    minute_percent: percent(minute),
  };
}

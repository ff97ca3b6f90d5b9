import type { State } from './protocol';

export const TRAIL_S = 3;

export interface TrailPoint {
  at_s: number; // capture time by the server's clock
  x: number;
  y: number;
}

/** Where the ball and each robot were in the last seconds. */
export class Trails {
  private readonly points = new Map<string, TrailPoint[]>();

  add(state: State): void {
    if (state.ball_track) this.append('ball', state.captured_s, state.ball_track.x_m, state.ball_track.y_m);
    for (const track of state.tracks) {
      if (track.id !== null) this.append(`${track.team} ${track.id}`, state.captured_s, track.x_m, track.y_m);
    }
    for (const [key, trail] of this.points) {
      while (trail.length > 0 && state.captured_s - trail[0]!.at_s > TRAIL_S) trail.shift();
      if (trail.length === 0) this.points.delete(key);
    }
  }

  clear(): void {
    this.points.clear();
  }

  entries(): IterableIterator<[string, TrailPoint[]]> {
    return this.points.entries();
  }

  private append(key: string, at_s: number, x: number, y: number): void {
    const trail = this.points.get(key) ?? [];
    const last = trail.at(-1);
    // Time that runs backwards: another run, or a clock that was set.
    if (last && at_s < last.at_s) trail.length = 0;
    trail.push({ at_s, x, y });
    this.points.set(key, trail);
  }
}

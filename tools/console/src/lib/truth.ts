import type { TeamName } from './message_types';
import type { RobotSighting, State } from './protocol';

/** How far the sightings of a frame are from where the arena says that everything was. */
export interface OffTruth {
  ball_mm: number | null; // null: not seen
  robots: number; // of the arena
  seen: number; // of these
  mean_mm: number | null; // of the seen ones; null: there is none
  max_mm: number | null;
  max_deg: number | null; // of the headings that were recognized
  missing: { team: TeamName; id: number }[]; // robots without a sighting
}

// A sighting without id belongs to the robot of its team that is at most so far away: about half a robot.
const UNNAMED_REACH_M = 0.04;

/** Null: the state has no truth, because the field is real. */
export function offTruth(state: State | null): OffTruth | null {
  const truth = state?.truth;
  if (!state || !truth) return null;
  const distance = (a: { x_m: number; y_m: number }, b: { x_m: number; y_m: number }) => Math.hypot(a.x_m - b.x_m, a.y_m - b.y_m);
  const unnamed = new Set(state.robots.filter(({ id }) => id === null));
  const find = (robot: { team: TeamName; id: number; x_m: number; y_m: number }): RobotSighting | undefined => {
    const named = state.robots.find(({ team, id }) => team === robot.team && id === robot.id);
    if (named) return named;
    const near = [...unnamed].filter((one) => one.team === robot.team && distance(one, robot) <= UNNAMED_REACH_M).sort((a, b) => distance(a, robot) - distance(b, robot))[0];
    if (near) unnamed.delete(near);
    return near;
  };
  const off_mm: number[] = [];
  const turned_deg: number[] = [];
  const missing: OffTruth['missing'] = [];
  for (const robot of truth.robots) {
    const sighting = find(robot);
    if (!sighting) {
      missing.push({ team: robot.team, id: robot.id });
      continue;
    }
    off_mm.push(1000 * distance(sighting, robot));
    if (sighting.heading_rad === null) continue;
    const turn = sighting.heading_rad - robot.heading_rad;
    turned_deg.push((180 / Math.PI) * Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn))));
  }
  const largest = (values: number[]) => (values.length > 0 ? Math.max(...values) : null);
  return {
    ball_mm: state.ball && truth.ball ? 1000 * distance(state.ball, truth.ball) : null,
    robots: truth.robots.length,
    seen: off_mm.length,
    mean_mm: off_mm.length > 0 ? off_mm.reduce((sum, value) => sum + value, 0) / off_mm.length : null,
    max_mm: largest(off_mm),
    max_deg: largest(turned_deg),
    missing,
  };
}

import type { TeamName } from './message_types';
import type { ArenaRequest } from './protocol';

/** Faults of the arena; docs/arena.md describes them. */
export const FAULTS = [
  'camera_stall', 'camera_lost', 'frame_short', 'frame_corrupt', 'dark', 'picture_frozen', 'picture_half_frozen', 'picture_torn', 'picture_turned', 'picture_random',
  'hide_robot', 'radio_lost', 'radio_busy', 'emergency_stop', 'start_button',
] as const;

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4] as const;

/** Largest values that the server takes. */
export const MAX_FRAMES = 3600;
export const MAX_THROW_MPS = 10;
export const MAX_SEED = 2 ** 53;
export const MAX_FAULT_S = 36000;
export const MAX_ROBOT_ID = 127;

/** The number in a field of a form, within the range that the server takes. */
export function within(value: number | null | undefined, least: number, most: number): number {
  return Number.isFinite(value) ? Math.min(Math.max(value!, least), most) : least;
}

/** A fault from now on for this time in s. `robot`: whom `hide_robot` hides; the other kinds concern no robot. */
export function faultOf(kind: string, duration: number, robot: { team: TeamName; id: number }): ArenaRequest {
  return { fault: { kind, for_s: duration, ...(kind === 'hide_robot' ? robot : {}) } };
}

/** The ball at a speed in m/s; the direction in degrees, counter-clockwise from x. */
export function throwOf(speed: number, degrees: number): ArenaRequest {
  const angle = (degrees * Math.PI) / 180;
  const rounded = (value: number) => Math.round(value * 1e4) / 1e4;
  return { throw: { vx: rounded(speed * Math.cos(angle)), vy: rounded(speed * Math.sin(angle)) } };
}

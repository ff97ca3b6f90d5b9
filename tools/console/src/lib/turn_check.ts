// Whether a robot that is driven turns as it is told. In a mirrored picture every turn is seen the other way round, and so it is if the robot's
// wheels are exchanged; nothing else about a standing robot shows either.

/** What a turn has shown: nothing yet, the commanded direction, or the other one. */
export type TurnVerdict = 'unknown' | 'same' | 'opposite';

// A command counts after the delay of radio, robot and camera. Below half a radian per second, pushes and slip of the wheels turn a robot as fast.
const DELAY_S = 0.4;
const LEAST_TURN_RADPS = 0.5;
// Angle that must be seen before there is a verdict: a tenth of it is the noise of a heading, a quarter what a collision turns.
const ENOUGH_RAD = 1.2;

/** Adds up the seen turns of one robot while the command keeps its sign. */
export class TurnCheck {
  private since_s = 0;
  private sign = 0;
  private last: number | null = null;
  private seen_rad = 0; // in the commanded direction
  verdict: TurnVerdict = 'unknown';

  /** `turn_radps`: commanded, counter-clockwise. `heading_rad`: seen at `time_s`, null if the robot is not seen. */
  add(time_s: number, turn_radps: number, heading_rad: number | null): TurnVerdict {
    const sign = Math.abs(turn_radps) < LEAST_TURN_RADPS ? 0 : Math.sign(turn_radps);
    if (sign !== this.sign || heading_rad === null) {
      this.sign = sign;
      this.since_s = time_s;
      this.last = null;
    }
    if (sign === 0 || heading_rad === null || time_s - this.since_s < DELAY_S) return this.verdict;
    if (this.last !== null) {
      const step = Math.atan2(Math.sin(heading_rad - this.last), Math.cos(heading_rad - this.last));
      this.seen_rad += sign * step;
    }
    this.last = heading_rad;
    if (Math.abs(this.seen_rad) > ENOUGH_RAD) {
      this.verdict = this.seen_rad > 0 ? 'same' : 'opposite';
      this.seen_rad = 0;
    }
    return this.verdict;
  }
}

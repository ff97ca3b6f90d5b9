import type { State } from './protocol';

/** After this time without a confirmation the page warns. A stop reaches the robots within two frames and the link's delay. */
export const STOP_WARNING_MS = 700;

/** A stop that was asked for. Only a state that is newer than the request and contains the halt confirms it. */
export class StopRequest {
  private after: number;
  confirmed = false;
  sent = false;
  number = 0; // of the message
  answered = false; // the server has passed it to the board's loop

  /** `last`: number of the newest state that was received before the request; -1: none. */
  constructor(
    last: number,
    readonly asked_ms: number,
  ) {
    this.after = last;
  }

  /** Another run of the program counts its states from 0. */
  restart(): void {
    this.after = -1;
    this.sent = this.answered = false;
  }

  accept(state: State): void {
    if (this.sent && state.number > this.after && state.halt.includes('console')) this.confirmed = true;
  }

  /** Sent with this number; 0: there is no connection. */
  passed(number: number): void {
    this.number = number;
    this.sent = number > 0;
  }

  /** Without frames there are no states; a status that follows the server's answer tells it as well. */
  acceptStatus(halt: readonly string[] | null | undefined): void {
    if (this.answered && halt?.includes('console')) this.confirmed = true;
  }

  isLate(now_ms: number): boolean {
    return !this.confirmed && now_ms - this.asked_ms > STOP_WARNING_MS;
  }
}

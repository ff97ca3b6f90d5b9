// Recordings on the board, as docs/console-protocol.md describes them (`/recordings`).
import type { Hello, State } from './protocol';

export interface RecordingScore {
  own: number;
  opponent: number;
  by: 'referee' | 'rule';
}

export interface ListedRecording {
  name: string;
  bytes: number;
  growing: boolean;
  complete: boolean;
  date: string; // UTC; '': the clock was not set
  duration_s: number;
  frames: number;
  goals: number;
  stops: number;
  lost: number;
  score: RecordingScore | null;
  problem: string; // why it cannot be shown
}

export type EventKind = 'score' | 'goal' | 'stop' | 'start' | 'robot_lost' | 'slowest';

export interface GameEvent {
  kind: EventKind;
  frame: number;
  at_s: number;
  team?: 'own' | 'opponent';
  by?: 'referee' | 'rule';
  own?: number;
  opponent?: number;
  halt?: string[];
  id?: number;
  latency_ms?: number;
}

export interface Recording {
  name: string;
  bytes: number;
  complete: boolean;
  damaged: number; // chunks that cannot be read
  frames: number;
  begin_s: number;
  duration_s: number;
  scenes: { frame: number; hello: Hello }[];
  events: GameEvent[];
}

export interface RecordedFrame {
  number: number;
  at_ms: number;
  state: State | null; // null: damaged
  jpeg: Blob | null; // null: not recorded, or damaged
}

export const addressOf = (name: string) => `recordings/${encodeURIComponent(name)}`;
export const fileAddress = (name: string) => `${addressOf(name)}/file`;

/** Fails with the server's words. */
async function get(address: string, signal?: AbortSignal): Promise<Response> {
  const answer = await fetch(address, { cache: 'no-store', ...(signal ? { signal } : {}) });
  if (!answer.ok) throw new Error((await answer.text()).trim() || answer.statusText);
  return answer;
}

/** `folder`: null: the board file names none. */
export async function listRecordings(): Promise<{ folder: string | null; recordings: ListedRecording[] }> {
  return (await (await get('recordings')).json()) as { folder: string | null; recordings: ListedRecording[] };
}

export async function openRecording(name: string): Promise<Recording> {
  return (await (await get(addressOf(name))).json()) as Recording;
}

export async function readFrames(name: string, from: number, count: number, step: number, signal?: AbortSignal): Promise<RecordedFrame[]> {
  return parseFrames(await (await get(`${addressOf(name)}/frames?from=${from}&count=${count}&step=${step}`, signal)).arrayBuffer());
}

const HEADER_BYTES = 16;

/** Frames follow each other: number, time in tenths of a millisecond, bytes of the state and of the picture (32 bits each), then both. */
export function parseFrames(data: ArrayBuffer): RecordedFrame[] {
  const view = new DataView(data);
  const frames: RecordedFrame[] = [];
  for (let place = 0; place + HEADER_BYTES <= data.byteLength; ) {
    const [number, at, stateBytes, pictureBytes] = [0, 4, 8, 12].map((offset) => view.getUint32(place + offset, true)) as [number, number, number, number];
    place += HEADER_BYTES;
    if (place + stateBytes + pictureBytes > data.byteLength) break;
    let state: State | null = null;
    try {
      if (stateBytes > 0) state = JSON.parse(new TextDecoder().decode(new Uint8Array(data, place, stateBytes))) as State;
    } catch {
      // Damaged: the frame is shown without results.
    }
    place += stateBytes;
    frames.push({ number, at_ms: at / 10, state, jpeg: pictureBytes > 0 ? new Blob([new Uint8Array(data, place, pictureBytes)], { type: 'image/jpeg' }) : null });
    place += pictureBytes;
  }
  return frames;
}

/** The next event of these kinds after the frame; after the last one the first again; null: there is none. */
export function nextEvent(events: readonly GameEvent[], kinds: readonly EventKind[], after: number): GameEvent | null {
  const wanted = events.filter(({ kind }) => kinds.includes(kind));
  return wanted.find(({ frame }) => frame > after) ?? wanted[0] ?? null;
}

/** Of the events of the slowest frame so far only the last one counts; scores are no place to jump to. */
export function shownEvents(events: readonly GameEvent[]): GameEvent[] {
  const slowest = events.filter(({ kind }) => kind === 'slowest').at(-1);
  return events.filter((event) => event.kind !== 'score' && (event.kind !== 'slowest' || event === slowest));
}

/** How many frames to go on, so that at most about 30 pictures a second are loaded. */
export function stepOf(rate_hz: number, speed: number): number {
  return Math.max(1, Math.round((rate_hz * speed) / 30));
}

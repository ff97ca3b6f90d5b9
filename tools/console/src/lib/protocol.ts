// The messages between server and page; docs/console-protocol.md describes them. Lengths are in meters, angles in radians
// counter-clockwise from x, times in seconds of the server's Unix time, unless the name says otherwise. The server adds new
// members at any time; a member that changes its meaning or disappears increases PROTOCOL.

import { expandRuns, type ValueGrid } from './findings';
import type { Rgb, TeamName } from './message_types';
import type { SetupCommand, SetupPicture, SetupMessage } from './setup_protocol';

export const PROTOCOL = 1;

export interface Field {
  length_m: number;
  width_m: number;
  goal_width_m: number;
  goal_depth_m: number;
  margin_m?: number;
  center_circle_m?: number; // radius; 0 or absent: not marked
  penalty_area_depth_m?: number;
  penalty_area_width_m?: number;
}

/** Pixels of a grid of field points, so that the page needs no camera model. Between them it interpolates. */
export interface Projection {
  x_min_m: number;
  y_min_m: number;
  step_m: number;
  columns: number; // along x
  rows: number; // along y
  /** One plane per height: the floor, and the markers of each team. */
  planes: { height_m: number; uv_px: (number | null)[] }[]; // u, v, u, v, ... row by row; null: not visible
}

export interface RobotDescription {
  team: TeamName;
  id: number;
  name?: string;
  color?: string; // name of the team's color
  rgb?: Rgb;
  length_m?: number; // of the outline, along the heading
  width_m?: number;
  height_m?: number; // of the marker above the floor
  patches?: { color: string; rgb: Rgb; x_m: number; y_m: number; radius_m: number }[];
}

export interface Hello {
  type: 'hello';
  protocol: number;
  version: string;
  board: string;
  venue: string;
  team: string;
  you: number;
  stop_line?: boolean; // the server takes a second connection for Stop
  time_s?: number;
  field: Field;
  camera: { width_px: number; height_px: number; rate_hz: number; description: string };
  projection?: Projection | null;
  robots: RobotDescription[];
  classes: { name: string; rgb: Rgb }[];
  verdicts?: { text: string; refused: boolean }[]; // of regions, by their number
  region_of_interest?: [number, number][]; // polygon in pixels; fewer than three points: the whole picture
  ball?: { color: string; rgb: Rgb; radius_m: number };
  stop_after_s: number;
  max_speed_mps?: number; // of own robots
  max_turn_radps?: number;
  using?: 'saved' | 'draft'; // the files
  arena?: boolean; // the field is simulated: its objects can be moved
  calibrated?: boolean; // false: camera, console and stop packets only
  setup?: boolean; // the program touchline-setup runs beside the firmware
}

/** touchline-setup was started or has ended. */
export interface SetupProgram {
  type: 'setup_program';
  running: boolean;
}

export interface BallSighting {
  x_m: number;
  y_m: number;
  u_px: number;
  v_px: number;
  confidence: number;
}

export interface RobotSighting {
  team: TeamName;
  id: number | null;
  x_m: number;
  y_m: number;
  heading_rad: number | null;
  u_px: number;
  v_px: number;
  confidence: number;
  outline_px: [number, number][];
  doubt?: string; // why it has no id
}

export interface RobotTrack {
  team: TeamName;
  id: number | null;
  seen: boolean; // false: predicted from earlier frames
  x_m: number;
  y_m: number;
  heading_rad: number;
  speed_mps: number;
  turn_radps: number;
  sigma_x_m: number;
  sigma_y_m: number;
  covariance_xy_m2: number;
  sigma_heading_rad: number;
  action: { x_m: number; y_m: number; heading_rad: number }; // predicted for the time at which the command acts
  confidence: number;
}

export interface BallTrack {
  seen: boolean;
  x_m: number;
  y_m: number;
  vx_mps: number;
  vy_mps: number;
  sigma_m: number;
  action: { x_m: number; y_m: number };
  confidence: number;
}

export type CommandSource = 'play' | 'external' | 'expired' | 'console';

export interface Command {
  id: number;
  left_mps: number;
  right_mps: number;
  source: CommandSource;
}

/** Figures of the halts `repeats`, `overload`, `field` and `motion`. */
export interface PictureFigures {
  repeated: number; // part of the picture that was delivered before, 0 to 1
  repeated_s: number; // its age
  field: number | null; // part of the field that is recognizable; null: not measured
  overload_frames: number; // in a row
  commanded: number; // own robots that have been commanded to move for some time; of these:
  standing: number;
  contradicting: number;
}

/** What the built-in play decided for a robot. */
export interface PlayDecision {
  id: number;
  job?: string; // absent: the goalkeeper, and a robot that is left over
  skill?: string;
  why?: string;
  target?: { x_m: number; y_m: number; heading_rad?: number }; // absent: it turns or stands where it is
  time_s?: number; // until it is there, as estimated when the jobs were given
}

/** Where an arena says that everything was when the picture was taken. */
export interface Truth {
  ball: { x_m: number; y_m: number };
  robots: { team: TeamName; id: number; x_m: number; y_m: number; heading_rad: number }[];
}

export interface State {
  type: 'state';
  number: number; // of processed frames; the picture with the same number belongs to this state
  frame: number;
  captured_s: number;
  sent_s?: number;
  latency_ms: number;
  ball: BallSighting | null;
  robots: RobotSighting[];
  truth?: Truth; // of an arena
  ball_track?: BallTrack | null;
  tracks: RobotTrack[];
  commands: Command[];
  stop: boolean; // the packet tells all robots to stop
  halt: string[]; // reasons: words of HALT_TEXTS
  stop_number?: number; // of the stop in force; a start names it
  waits_for_start?: boolean; // a start ends one of the reasons
  referee?: { phase: string };
  roles?: { id: number; role: 'goalkeeper' | 'attacker' | 'supporter' }[];
  play?: PlayDecision[];
  score?: { own: number; opponent: number; source?: 'referee' | 'console' } | null;
  picture?: PictureFigures;
  brightness?: number; // of the light, relative to the calibration
  stages_ms?: number[]; // region, marker, track, control, radio
}

/** Regions of the picture that follows. */
export interface Regions {
  type: 'regions';
  number: number;
  /** left, top, right, bottom (inclusive), class, area in pixels, verdict */
  regions: [number, number, number, number, number, number, number][];
  left_out: number;
}

/** Answer to `probe`. */
export interface ProbeResult {
  number: number; // of the picture
  u_px: number;
  v_px: number;
  space: 'rgb' | 'yuv';
  value: Rgb; // of the camera
  rgb: Rgb;
  class: number; // 0: background; 255: outside the region of interest
  light: Rgb; // levels by which the channels are corrected
  floor: { x_m: number; y_m: number } | null;
  region: { area_px: number; verdict: string } | null;
}

export type FindingsName = 'classes' | 'regions' | 'light';

export interface LatencySummary {
  count: number;
  p50_ms: number;
  p99_ms: number;
  p999_ms: number;
  max_ms: number;
  bins: [number, number, number][]; // from and to in milliseconds, count; without empty bins
}

export interface RobotRadio {
  id: number;
  battery_v: number | null;
  battery_low?: boolean;
  link_percent: number | null;
  left_mps?: number; // of robots that report the speeds of their wheels
  right_mps?: number;
  age_s: number;
}

/** A value that was measured while robots drove. */
export interface Measured {
  value: number;
  sigma: number;
  is_known: boolean;
}

/** The value in the files, the one in force, and the measured one. */
export interface Compared {
  stated: number;
  used: number;
  measured: Measured | null;
}

export interface RobotDrive {
  id: number;
  delay_s: Measured | null;
  lag_s: Measured | null;
  gain_left: Compared;
  gain_right: Compared;
}

export interface Drives {
  delay_s: Compared;
  lag_s: Compared;
  robots: RobotDrive[];
}

/** A device that cannot be opened: the program goes on trying. */
export interface LostDevice {
  device: 'camera' | 'radio' | 'gpio';
  reason: string;
}

/** What the recorder does. */
export interface RecordingStatus {
  on: boolean;
  file: string; // that is being written, else the last one; '': none yet
  duration_s: number;
  bytes: number;
  frames: number;
  pictures: number;
  lost_frames: number;
  lost_pictures: number;
  ended: string; // why the last one ended
}

export interface Status {
  type: 'status';
  recording?: RecordingStatus | null; // null: nothing can be recorded
  time_s: number;
  elapsed_s: number;
  halt?: string[] | null; // also without frames; null: the board's loop is silent
  stop_number?: number;
  waits_for_start?: boolean;
  lost?: LostDevice[];
  rate_hz: number;
  latency: { start: LatencySummary; minute: LatencySummary };
  deadline_ms?: number;
  deadlines_missed?: number;
  frames: number;
  frames_lost: number;
  overloads?: number;
  faults?: number;
  cpu_percent?: number | null; // of one processor
  temperature_c?: number | null;
  memory_mb?: number | null;
  radio: { packets: number; dropped: number; refused?: number; stop_packets?: number };
  telemetry?: RobotRadio[];
  drives?: Drives;
  adaptation?: 'follow' | 'frozen' | 'off';
  clients: number;
}

export interface EventLine {
  type: 'event';
  time_s: number;
  level: 'info' | 'warning' | 'error';
  text: string;
}

export interface Driver {
  type: 'driver';
  driver: number | null;
  you: boolean;
}

export interface Answer {
  type: 'answer';
  to: number;
  ok: boolean;
  error?: string;
  result?: unknown; // of a setup command
}

export type ServerMessage = Hello | State | Status | EventLine | Driver | Answer | Regions | SetupProgram | SetupMessage;

/** What is wanted of a simulated field. */
export type ArenaRequest =
  | { pause: Record<string, never> }
  | { resume: Record<string, never> }
  | { step: { frames: number } }
  | { speed: { factor: number } }
  | { reset: { seed: number } }
  | { throw: { vx: number; vy: number } }
  | { fault: { kind: string; for_s: number; team?: TeamName; id?: number } };

export type ClientMessage =
  | { type: 'watch'; picture: { rate_hz: number; max_width_px: number } | null; state_hz: number; setup?: boolean; findings?: FindingsName[] }
  | { type: 'probe'; u_px: number; v_px: number }
  | { type: 'score'; own: number; opponent: number }
  | ({ type: 'setup' } & SetupCommand)
  | { type: 'seen'; number: number }
  | { type: 'stop' }
  | { type: 'start'; stop_number: number }
  | { type: 'take' }
  | { type: 'release' }
  | { type: 'ping' }
  | { type: 'drive'; id: number; speed_mps: number; turn_radps: number }
  | { type: 'drive'; id: number; give_back: true }
  | { type: 'adaptation'; action: 'freeze' | 'follow' | 'reset' }
  | { type: 'arena'; do: ArenaRequest }
  | { type: 'recording'; action: 'start' | 'stop' }
  | { type: 'recording'; action: 'delete'; name: string }
  | { type: 'move'; u_px: number; v_px: number; to_u_px: number; to_v_px: number };

/** Header of a binary message: 32 bytes, little-endian; the content follows: a JPEG of the camera, or a picture of the setup. */
export const BINARY_HEADER_BYTES = 32;
export const BINARY_MAGIC = 0x43504c54;
const KIND_CAMERA = 1;
const KIND_SETUP = 2;
const KIND_CLASSES = 4;
const KIND_LIGHT = 5;

export interface PictureHeader {
  width_px: number;
  height_px: number;
  full_width_px: number; // of the camera; overlays are in its pixels
  number: number;
  captured_s: number;
}

/** Returns null if the message is of another version. */
function readKind(data: ArrayBuffer): { view: DataView; kind: number } | null {
  if (data.byteLength <= BINARY_HEADER_BYTES) return null;
  const view = new DataView(data);
  return view.getUint32(0, true) === BINARY_MAGIC && view.getUint8(4) === 1 ? { view, kind: view.getUint8(5) } : null;
}

/** Returns null if the message is not a picture of a known version. */
export function readPictureHeader(data: ArrayBuffer): PictureHeader | null {
  const message = readKind(data);
  if (message?.kind !== KIND_CAMERA) return null;
  const { view } = message;
  const header = {
    width_px: view.getUint16(6, true),
    height_px: view.getUint16(8, true),
    full_width_px: view.getUint16(10, true),
    number: Number(view.getBigUint64(16, true)),
    captured_s: Number(view.getBigInt64(24, true)) / 1e6,
  };
  return header.width_px > 0 && header.height_px > 0 && header.full_width_px > 0 ? header : null;
}

/** Returns null if the message is not a picture of the setup. */
export function readSetupPicture(data: ArrayBuffer): SetupPicture | null {
  const message = readKind(data);
  if (message?.kind !== KIND_SETUP) return null;
  const content = data.slice(BINARY_HEADER_BYTES);
  const type = new DataView(content).getUint8(0) === 0x89 ? 'image/png' : 'image/jpeg';
  return { id: message.view.getUint32(12, true), content: new Blob([content], { type }) };
}

/** Returns null if the message is neither classes nor light of a picture. */
export function readValueGrid(data: ArrayBuffer): { name: 'classes' | 'light'; number: number; grid: ValueGrid } | null {
  const message = readKind(data);
  if (message?.kind !== KIND_CLASSES && message?.kind !== KIND_LIGHT) return null;
  const { view, kind } = message;
  const [columns, rows] = [view.getUint16(6, true), view.getUint16(8, true)];
  const values = expandRuns(new DataView(data, BINARY_HEADER_BYTES), columns * rows);
  if (!values || columns === 0) return null;
  // A class stands for a pixel of the picture as it is sent.
  const scale = Math.floor(view.getUint16(10, true) / columns);
  const tile: [number, number] = kind === KIND_LIGHT ? [view.getUint16(12, true), view.getUint16(14, true)] : [scale, scale];
  return { name: kind === KIND_LIGHT ? 'light' : 'classes', number: Number(view.getBigUint64(16, true)), grid: { columns, rows, values, tile } };
}

/** Reads a text message. Returns null if it is not an object with a type. */
export function readMessage(text: string): ServerMessage | null {
  try {
    const message: unknown = JSON.parse(text);
    if (typeof message !== 'object' || message === null || !('type' in message)) return null;
    return message as ServerMessage;
  } catch {
    return null;
  }
}

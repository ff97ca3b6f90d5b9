// The messages of the guided setup; docs/console-protocol.md describes them. The program touchline-setup sends state and pictures, the
// firmware relays them. Pixels are those of the camera's full picture; (0, 0) is the center of the top-left one. Members that an older
// program does not send are optional.

import type { Rgb, TeamName } from './message_types';

export const SETUP_STEPS = ['camera', 'field', 'light', 'robots', 'colors', 'radio'] as const;
export type StepName = (typeof SETUP_STEPS)[number];

export type Level = 'none' | 'ok' | 'warning' | 'bad'; // none: nothing was measured yet
export type KeyValue = number | string | boolean | null;

export interface Quality {
  level: Level;
  text: string;
  number?: number | null;
  unit?: string;
}

/** Id of a picture that came as a binary message; 0 or null: none. */
export type PictureId = number | null;

export interface Step {
  done: boolean;
  quality: Quality;
  notes?: { level: Level; text: string }[];
}

export interface CameraMeasure {
  histogram?: number[][]; // red, green, blue: shares of the pixels, from black to white
  clipped?: number[]; // share of each channel
  black?: number[];
  mean?: number[];
  focus?: number | null; // contrast of the finest details, 0 to 1
  blur_px?: number | null; // of the fastest robot during the exposure
  exposure_limit_us?: number | null; // blurs it by one pixel
  quality?: Quality;
}

export interface CameraStep extends Step, Omit<CameraMeasure, 'quality'> {
  values: Record<string, KeyValue>;
}

export interface FieldPreset {
  name: string;
  title?: string;
  length_m?: number;
  width_m?: number;
}

/** What a person says about the field; 0 and '': nothing. */
export interface FieldEntry {
  preset: string;
  length_m: number;
  width_m: number;
  camera_height_m: number;
  ignore_lines: boolean;
}

export interface FieldStep extends Step {
  values: Record<string, KeyValue>;
  presets: (FieldPreset | string)[];
  camera_height_m?: number | null;
  camera_height_sigma_m?: number | null;
  tilt_rad?: number | null;
  seen_height_m?: number | null; // what the picture alone says
  seen_height_sigma_m?: number | null;
  entered?: FieldEntry | null; // by a person, for this result
  rms_mm?: number | null;
  p95_mm?: number | null;
  max_mm?: number | null;
  rms_px?: number | null;
  top_sigma_mm?: number | null; // of a robot's top in the worst corner
  top_assumes?: string; // what that figure assumes, as the end of a sentence
  corners_px?: [number, number][] | null; // -x-y, +x-y, +x+y, -x+y
  overlay?: [number, number][][]; // the model's lines, as the picture must show them
  report?: string;
  error_map?: PictureId;
}

export type LightSurface = 'grey' | 'field' | 'moving' | 'border';

export interface LightStep extends Step {
  surface?: LightSurface | null;
  least?: number[] | number; // of each channel, relative to the middle
  most?: number[] | number;
  saturated_cells?: number;
  dark_cells?: number;
  spots?: number;
  before?: PictureId;
  after?: PictureId;
}

export interface ColorsStep extends Step {
  names: { name: string; shown_rgb?: Rgb; boxes?: unknown[] }[];
  wanted: string[]; // of the team file, without a box
  needed?: string[]; // of the team file
  pictures: number[]; // that clicks refer to
  clicks: { name: string; u_px: number; v_px: number; picture?: number; used?: boolean; reason?: string }[];
  confusion?: { names?: string[]; rows: number[][] } | number[][] | null; // rows: colors; columns: background, then the colors
  margins?: { a: string; b: string; levels: number }[];
  self_check?: string;
  advice?: string[];
  found?: number[];
  checks?: number[];
  mask?: PictureId; // every pixel that the last change caught or lost
}

export interface LayoutPatch {
  role?: string; // 'team' or 'identification'; the first patch is the team's
  outline: string; // square, bar, triangle, circle
  x_m: number;
  y_m: number;
  length_m: number;
  width_m: number;
  turn_rad?: number;
}

export interface RobotLayout {
  name: string;
  own?: boolean; // of the team file
  robot_side_m?: number;
  height_m?: number; // of the patches above the floor
  body_turn_rad?: number;
  patches: LayoutPatch[];
}

export interface TeamTable {
  layout: string;
  color: string;
  robots: { id: number; colors: string[]; name?: string }[];
}

export interface RobotRef {
  team: TeamName;
  id: number;
}

/** Standard deviations that the pictures themselves do not show. */
export interface HiddenNoise {
  robot_position_mm: number;
  robot_heading_deg: number;
  ball_position_mm: number;
}

/** How much the sightings of what stands still scatter. */
export interface NoiseMeasure {
  objects: { name: string; sightings: number; position_mm: number; heading_deg: number | null }[];
  left_out: string[];
  has_ball: boolean;
  hidden: HiddenNoise;
  before: HiddenNoise;
}

export interface RobotsStep extends Step {
  layouts: RobotLayout[];
  palette?: { name: string; rgb?: Rgb | null }[]; // usual names of paints, and those in use, with their usual looks
  own: TeamTable;
  opponent: TeamTable;
  ball?: string;
  ball_radius_m?: number;
  problems?: (string | { text: string; robots?: RobotRef[] })[];
  similar?: { a: RobotRef; b: RobotRef; levels: number }[];
  noise?: NoiseMeasure | null;
}

/** The newest bytes of a robot, decoded, a line for each field. */
export interface RadioExchange {
  sent: string;
  received: string;
  packets: number;
  received_bytes: number;
}

export type DrivePattern = 'forward' | 'backward' | 'turn' | 'left-wheel' | 'right-wheel' | 'to-and-fro';

/** The drive of a robot, as its motion under the camera shows it. */
export interface DriveMeasure {
  robot: number;
  wiring: string;
  wiring_ok: boolean;
  values: { name: string; value: number | null; sigma: number | null; unit: string; known: boolean }[];
  keys: { key: string; file: string; now: string; measured: string; unit: string; differs: boolean; written: boolean }[];
}

export interface RadioStep extends Step {
  values: Record<string, KeyValue>;
  format: string; // what the robots understand
  formats: { name: string; about: string }[]; // without the own fields of a team file
  sample: string; // the bytes of a packet, a line for each field; '': the fields are wrong
  remarks: string; // warnings, or what is wrong, a line each
  devices: (string | { name: string; description?: string })[];
  drive?: DriveMeasure | null;
}

export interface SetupSteps {
  camera: CameraStep;
  field: FieldStep;
  light: LightStep;
  colors: ColorsStep;
  robots: RobotsStep;
  radio: RadioStep;
}

export interface SetupState {
  open: boolean; // a draft exists
  board?: string;
  busy: { command: string; text: string; progress: number | null; exchange?: RadioExchange } | null; // exchange: of a robot that is driven
  error: string | null;
  preview?: { source: 'draft' | 'saved'; ok?: boolean; error?: string }; // what the firmware runs with
  trying?: boolean; // robots play with the draft
  changed_files: string[];
  undo: string[]; // the last one is next
  redo: string[];
  steps: SetupSteps;
}

export interface SetupMessage {
  type: 'setup';
  state?: Partial<SetupState>;
}

type FieldSize = { camera_height_m: number; ignore_lines: boolean } & ({ preset: string } | { length_m: number; width_m: number });

/** The page's commands: {type: 'setup', request, ...}. Only the driver's are carried out. The answer comes when the work is done. */
export type SetupCommand =
  | { command: 'begin' | 'discard' | 'undo' | 'redo' | 'cancel' | 'colors.picture' | 'colors.reset' | 'robots.noise' }
  | { command: 'differences' } // result: Differences
  | { command: 'save'; overwrite?: boolean }
  | { command: 'export' } // result: {name, text}
  | { command: 'import'; part: number; parts: number; text: string }
  | { command: 'picture'; id: number }
  | { command: 'use'; source: 'draft' | 'saved' }
  | { command: 'try' | 'drive'; on: boolean }
  | { command: 'confirm'; step: StepName }
  | { command: 'set'; key: string; value: KeyValue; continues?: boolean }
  | { command: 'camera.quality' } // result: CameraMeasure; not a step of undo
  | ({ command: 'field.find' } & FieldSize)
  | ({ command: 'field.corners'; corners_px: [number, number][] } & FieldSize)
  | { command: 'light.measure'; surface: LightSurface }
  | { command: 'colors.find'; accept?: boolean }
  | { command: 'colors.click'; name: string; u_px: number; v_px: number; picture?: number }
  | { command: 'colors.remove'; click: number }
  | { command: 'robots.set'; own?: TeamTable; opponent?: TeamTable; ball?: { color?: string; radius_m?: number }; layout?: RobotLayout }
  | { command: 'camera.set'; backend?: string; device?: string; format?: string; width_px?: number; height_px?: number; rate_hz?: number }
  | { command: 'radio.set'; backend?: string; device?: string; baud?: number }
  | { command: 'radio.set'; format: string }
  | { command: 'radio.pattern'; robot: number; pattern: DrivePattern; speed_mps?: number; duration_s?: number } // result: RadioExchange
  | { command: 'radio.measure'; robot: number }
  | { command: 'radio.write'; key: string }; // a measured value, into the draft

export interface Differences {
  files: { name: string; diff: string }[]; // unified; '': a picture that differs
  conflicts?: string[]; // saved files that somebody else has changed
  problems?: string;
}

/** A binary message of kind 2. */
export interface SetupPicture {
  id: number;
  content: Blob;
}

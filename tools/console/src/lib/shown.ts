import type { ValueGrid } from './findings';
import type { PixelMap } from './projection';
import type { FindingsName, Hello, PictureHeader, Regions, State } from './protocol';
import type { Trails } from './trails';

export interface Picture {
  image: ImageBitmap;
  header: PictureHeader;
  state: State | null; // of the same frame
  findings: Findings;
}

/** How a picture was understood, as far as it was asked for. */
export interface Findings {
  regions?: Regions;
  classes?: HTMLCanvasElement;
  classesGrid?: ValueGrid;
  light?: HTMLCanvasElement;
  lightGrid?: ValueGrid;
}

/** What the drawings of picture and field show: the running game, or a recording. */
export interface Shown {
  readonly phase: 'connecting' | 'open' | 'lost';
  readonly hello: Hello | null;
  readonly state: State | null;
  readonly picture: Picture | null;
  readonly pixelMap: PixelMap | null;
  readonly trails: Trails;
  readonly stale: boolean;
  /** Says which picture the page needs; absent: pictures come without it. */
  watch?(picture: { rate_hz: number; max_width_px: number } | null, findings?: FindingsName[]): void;
}

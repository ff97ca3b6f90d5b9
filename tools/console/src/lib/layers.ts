import type { FindingsName } from './protocol';

/** Overlays of the live picture. Each is drawn by one function of overlay.ts; a new one is added here and there. */
export const LAYERS = [
  { key: 'robots', label: 'Robots seen', hint: 'outline, id and confidence of each marker in this picture', color: '#ffffff' },
  { key: 'ball', label: 'Ball', hint: 'the ball seen in this picture', color: '#ffb04a' },
  { key: 'tracks', label: 'Tracks', hint: 'filtered poses; the ellipse is three standard deviations', color: '#3fe0d0' },
  { key: 'action', label: 'When commands act', hint: 'predicted poses for the time at which the command takes effect', color: '#ff8ad8' },
  { key: 'truth', label: 'Truth', hint: 'where the arena says that robots and ball were in this picture; a real field has none', color: '#ff4fc3' },
  { key: 'play', label: 'Play', hint: 'where the built-in play sends each robot, and by which skill; the way leads around other robots', color: '#a6f06a' },
  { key: 'lines', label: 'Field lines', hint: 'the venue file\'s field through the camera model; lines that miss the field show a wrong calibration', color: '#ffe14a' },
  { key: 'classes', label: 'Classes', hint: 'the color class of every pixel; background is darkened', color: '#57d957' },
  { key: 'regions', label: 'Regions', hint: 'boxes of the regions of one class', color: '#d0d7dd' },
  { key: 'refusals', label: 'Refusals', hint: 'why a region was not used, and why a robot has no id', color: '#ff6b5e' },
  { key: 'interest', label: 'Region of interest', hint: 'the part of the picture that is examined', color: '#c792ff' },
  { key: 'light', label: 'Light', hint: 'light map: yellow is brighter than where the colors were learned, blue is darker', color: '#ffde28' },
  { key: 'trails', label: 'Trails', hint: 'the last three seconds', color: '#9db4ff' },
] as const;

export type LayerKey = (typeof LAYERS)[number]['key'];

export const LAYER_COLORS = Object.fromEntries(LAYERS.map((layer) => [layer.key, layer.color])) as Record<LayerKey, string>;

/** The layers that can show something: only an arena states the truth. */
export const layersOf = (hasTruth: boolean) => LAYERS.filter(({ key }) => key !== 'truth' || hasTruth);

/** What these layers need beside pictures and states. */
export function findingsOf(layers: ReadonlySet<LayerKey>): FindingsName[] {
  const names: FindingsName[] = [];
  if (layers.has('classes')) names.push('classes');
  if (layers.has('regions') || layers.has('refusals')) names.push('regions');
  if (layers.has('light')) names.push('light');
  return names;
}

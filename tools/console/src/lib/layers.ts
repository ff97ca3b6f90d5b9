/** Overlays of the live picture. Each is drawn by one function of overlay.ts; a new one is added here and there. */
export const LAYERS = [
  { key: 'robots', label: 'Robots seen', hint: 'outline, id and confidence of each marker in this picture', color: '#ffffff' },
  { key: 'ball', label: 'Ball', hint: 'the ball seen in this picture', color: '#ffb04a' },
  { key: 'tracks', label: 'Tracks', hint: 'filtered poses; the ellipse is three standard deviations', color: '#3fe0d0' },
  { key: 'action', label: 'When commands act', hint: 'predicted poses for the time at which the command takes effect', color: '#ff8ad8' },
  { key: 'lines', label: 'Field lines', hint: 'the venue file\'s field through the camera model; lines that miss the field show a wrong calibration', color: '#ffe14a' },
  { key: 'trails', label: 'Trails', hint: 'the last three seconds', color: '#9db4ff' },
] as const;

export type LayerKey = (typeof LAYERS)[number]['key'];

export const LAYER_COLORS = Object.fromEntries(LAYERS.map((layer) => [layer.key, layer.color])) as Record<LayerKey, string>;

// Keys of the board file that the guided setup offers. docs/files.md describes them; the setup program checks every value.

export interface KeyDescription {
  key: string;
  label: string;
  unit?: string;
  low?: number;
  high?: number;
  slider?: [number, number, number]; // from, to, step: the range that people need
  choices?: { value: number | string; text: string }[];
  text?: boolean;
  unset?: number; // this value leaves the setting to the camera
}

const same = (...values: (number | string)[]) => values.map((value) => ({ value, text: String(value) }));

export const CAMERA_KEYS: KeyDescription[] = [
  { key: 'exposure_us', label: 'Exposure', unit: 'us', low: 0, high: 1000000, slider: [100, 16000, 100], unset: 0 },
  { key: 'gain', label: 'Gain', low: 0, high: 65535, slider: [0, 255, 1], unset: 0 },
  { key: 'white_balance_k', label: 'White balance', unit: 'K', low: 0, high: 20000, slider: [2500, 7500, 50], unset: 0 },
  { key: 'power_line', label: 'Lamp flicker', choices: [{ value: 'leave', text: 'as it is' }, { value: 'off', text: 'not suppressed' }, { value: '50hz', text: '50 Hz mains' }, { value: '60hz', text: '60 Hz mains' }] },
];

export const CAMERA_MODE_KEYS: KeyDescription[] = [
  { key: 'device', label: 'Device', text: true },
  { key: 'format', label: 'Pixel format', choices: same('rgb24', 'bgr24', 'yuyv', 'uyvy', 'nv12', 'i420', 'xrgb8888', 'yuvj422p', 'mjpg') },
  { key: 'width_px', label: 'Width', unit: 'px', low: 16, high: 2592 },
  { key: 'height_px', label: 'Height', unit: 'px', low: 16, high: 1944 },
  { key: 'rate_hz', label: 'Rate', unit: 'frames/s', low: 0, high: 1000 },
];

export const BAUD_RATES = [9600, 19200, 38400, 57600, 115200, 230400, 460800, 1000000];

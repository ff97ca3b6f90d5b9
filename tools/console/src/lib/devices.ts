// What GET /devices and GET /ports answer (docs/console-protocol.md), and what the page says about it.

export interface CameraMode {
  backend?: string; // 'v4l2' if absent
  device: string;
  format: string;
  width_px: number;
  height_px: number;
  rate_hz: number;
}

export interface CameraSize {
  width_px: number;
  height_px: number;
  max_width_px?: number; // of a range of sizes
  max_height_px?: number;
  rates_hz?: number[];
  rate_range_hz?: number[];
}

export interface CameraDevice {
  backend?: string;
  path: string;
  name: string; // for the board file: a link that lasts, if there is one
  by_id?: string;
  by_path?: string;
  card?: string;
  bus?: string;
  formats?: { format: string; sizes: CameraSize[] }[]; // format: '' or a code if Touchline does not read it
  used?: boolean; // named by the files in use
  suggested?: CameraMode;
  thumbnail?: string;
  refused?: string;
}

export interface SerialPort {
  path: string;
  name: string;
  description?: string;
  kind?: string;
  refused?: string;
}

export interface GpioChip {
  path: string;
  label?: string;
  line_count?: number;
  refused?: string;
}

export interface Ports {
  serial_ports: SerialPort[];
  gpio_chips: GpioChip[];
  problems?: string[]; // kinds of devices that could not be listed, and why
}

export interface Devices extends Ports {
  cameras: CameraDevice[];
}

// One list is made at a time; with a few cameras it takes this long.
const BUSY_RETRIES = 20;
const BUSY_PAUSE_MS = 1000;

/** Asks the board for its devices. Another page may be asking: then it is asked again. Throws an Error that says what is wrong. */
export async function fetchDevices<T extends Ports>(path: '/devices' | '/ports', get: typeof fetch = fetch, pause_ms = BUSY_PAUSE_MS): Promise<T> {
  for (let attempt = 0; ; attempt += 1) {
    const response = await get(path, { cache: 'no-store' });
    if (response.ok) return (await response.json()) as T;
    if (response.status !== 503 || attempt === BUSY_RETRIES) throw new Error((await response.text()).trim() || `The board answered with status ${response.status}.`);
    await new Promise((resolve) => setTimeout(resolve, pause_ms));
  }
}

const rounded = (rate: number) => String(Math.round(10 * rate) / 10);

export function rateText({ rates_hz, rate_range_hz }: CameraSize): string {
  if (rate_range_hz?.length) return `${rounded(Math.min(...rate_range_hz))} to ${rounded(Math.max(...rate_range_hz))} Hz`;
  if (!rates_hz?.length) return 'rate unknown';
  return `${[...rates_hz].sort((a, b) => b - a).map(rounded).join(', ')} Hz`;
}

export function sizeText({ width_px, height_px, max_width_px, max_height_px }: CameraSize): string {
  const least = `${width_px} × ${height_px}`;
  return max_width_px || max_height_px ? `${least} to ${max_width_px ?? width_px} × ${max_height_px ?? height_px}` : least;
}

export const modeText = ({ format, width_px, height_px, rate_hz }: CameraMode) => `${format}, ${width_px} × ${height_px}, ${rounded(rate_hz)} Hz`;

/** The cameras with `used` for the one that the files in use name. If they name none of them, the board has said which one is used. */
export function withUsed(cameras: CameraDevice[], device: string): CameraDevice[] {
  const isNamed = ({ path, name, by_id, by_path }: CameraDevice) => device !== '' && [path, name, by_id, by_path].includes(device);
  return cameras.some(isNamed) ? cameras.map((camera) => ({ ...camera, used: isNamed(camera) })) : cameras;
}

/** What a camera is, besides its name: whether it can be chosen, and in one sentence why not. `lost`: why the loop has no camera, if so. */
export function cameraState(camera: CameraDevice, lost: string | null): { choosable: boolean; text: string; problem: boolean } {
  if (camera.used && lost === null) return { choosable: false, text: 'In use: this is the picture of this page.', problem: false };
  if (camera.refused) return { choosable: false, text: camera.refused, problem: true };
  if (!camera.suggested) return { choosable: false, text: 'It offers no format that Touchline reads.', problem: true };
  if (camera.used) return { choosable: true, text: `The board file names this camera, but: ${lost}`, problem: true };
  return { choosable: true, text: '', problem: false };
}

/** What stands in the place of the small picture of a camera that cannot show one. The whole reason is beside it. */
export function pictureText({ refused }: CameraDevice): string {
  if (!refused) return '';
  const user = /: (in use by [^;]+)/.exec(refused)?.[1];
  if (user) return user[0]!.toUpperCase() + user.slice(1);
  return /does not answer/.test(refused) ? 'Does not answer' : 'No picture';
}

/** The keys of [camera] for a camera that a person chooses. */
export const cameraKeys = ({ backend = 'v4l2', device, format, width_px, height_px, rate_hz }: CameraMode) => ({ backend, device, format, width_px, height_px, rate_hz });

/** Whether a port's name depends on the order in which adapters are plugged in. */
export const isNumbered = (name: string) => /^\/dev\/tty(USB|ACM)\d+$/.test(name);

/** Ports that people plug in come first; the many that a processor has built in are usually not wired. Those that cannot be opened come last. */
export function sortedPorts(ports: SerialPort[]): SerialPort[] {
  const rank = ({ kind, refused }: SerialPort) => (refused ? 3 : kind === 'usb' ? 0 : kind === 'native' ? 1 : 2);
  return [...ports].sort((a, b) => rank(a) - rank(b) || a.path.localeCompare(b.path, 'en', { numeric: true }));
}

/** The port that a board file means: by its lasting name or by its number. */
export const portNamed = (ports: SerialPort[], device: string) => ports.find(({ name, path }) => name === device || path === device);

export function chipText(chips: GpioChip[]): string {
  if (!chips.length) return 'GPIO chips: none.';
  return `GPIO chips: ${chips.map(({ path, label, line_count, refused }) => refused ?? `${label || path}${line_count ? ` (${line_count} lines)` : ''}`).join(', ')}. Lamps and buttons are entered in the board file, section [gpio].`;
}

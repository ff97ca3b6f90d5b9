const missing = '–';

/** Wheel speeds that a robot reports, or a dash. */
export function wheels(robot: { left_mps?: number; right_mps?: number } | undefined): string {
  if (robot?.left_mps === undefined || robot.right_mps === undefined) return '–';
  return `${fixed(robot.left_mps, 2)}, ${fixed(robot.right_mps, 2)} m/s`;
}

/** A measured value and its standard deviation times `factor`, or a dash: "62.1 ± 0.4". */
export function measured(value: { value: number; sigma: number } | null | undefined, factor: number): string {
  return value ? `${fixed(factor * value.value, 1)} ± ${fixed(factor * value.sigma, 1)}` : missing;
}

/** A number with fixed decimals, or a dash. */
export function fixed(value: number | null | undefined, decimals: number): string {
  return value === null || value === undefined || !Number.isFinite(value) ? missing : value.toFixed(decimals);
}

/** 1234567 -> "1 234 567", with narrow spaces. */
export function count(value: number | null | undefined): string {
  if (value === null || value === undefined) return missing;
  return Math.round(value).toString().replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** 75 -> "1 min 15 s" */
export function duration(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const h = Math.floor(whole / 3600);
  const min = Math.floor(whole / 60) % 60;
  if (h > 0) return `${h} h ${min} min`;
  return min > 0 ? `${min} min ${whole % 60} s` : `${whole} s`;
}

/** The server's Unix time as time of day, "14:03:12". */
export function timeOfDay(unix_s: number): string {
  const date = new Date(unix_s * 1000);
  if (Number.isNaN(date.getTime())) return missing;
  return [date.getHours(), date.getMinutes(), date.getSeconds()].map((part) => String(part).padStart(2, '0')).join(':');
}

export function cssColor(rgb: readonly number[] | undefined, fallback: string): string {
  if (!rgb || rgb.length !== 3 || rgb.some((value) => !Number.isFinite(value))) return fallback;
  return `rgb(${rgb.map((value) => Math.round(value)).join(' ')})`;
}

/** Without the digits that a number of 32 bits does not have: 2.200000047683716 -> 2.2 */
export function rounded(value: number): number {
  return Number(value.toPrecision(6));
}

/** 12345678 -> "12.3 MB" */
export function megabytes(bytes: number): string {
  return bytes >= 1e9 ? `${fixed(bytes / 1e9, 2)} GB` : `${fixed(bytes / 1e6, 1)} MB`;
}

/** 75.25 -> "1:15.3" */
export function clock(seconds: number): string {
  const tenths = Math.max(0, Math.round(10 * seconds));
  const rest = (tenths % 600) / 10;
  return `${Math.floor(tenths / 600)}:${rest < 10 ? '0' : ''}${rest.toFixed(1)}`;
}

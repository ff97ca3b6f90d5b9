// The version of Touchline, which server and page share.
import { readFileSync } from 'node:fs';

export const version = /project\(touchline VERSION ([\d.]+)/.exec(readFileSync(new URL('../../../CMakeLists.txt', import.meta.url), 'utf8'))?.[1] ?? 'unknown';

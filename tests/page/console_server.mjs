// Starts a console to test the page with: the real program, or the page's rehearsal server.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

const rehearsal = fileURLToPath(new URL('../../tools/console/dev/server.js', import.meta.url));

// Whatever ends this process, its servers end, too.
const children = new Set();
process.on('exit', () => children.forEach((child) => child.kill('SIGKILL')));
for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) process.on(signal, () => process.exit(1));

/** Returns {found, pid, output(), end()}; `found` is what `ready` matches in the program's output. `each` gets its lines. Fails with the program's output if it ends before. */
export async function start(command, options, ready, each = () => {}) {
  const child = spawn(command, options, { stdio: ['ignore', 'pipe', 'pipe'] });
  children.add(child);
  child.on('exit', () => children.delete(child));
  const lines = [];
  const found = await new Promise((resolve, reject) => {
    for (const stream of [child.stdout, child.stderr]) {
      createInterface(stream).on('line', (line) => {
        lines.push(line);
        each(line);
        const match = ready.exec(line);
        if (match) resolve(match[0]);
      });
    }
    child.on('error', reject);
    child.on('exit', () => reject(new Error(`${command} ended:\n${lines.join('\n')}`)));
  });
  const end = async (signal = 'SIGTERM') => {
    if (child.exitCode !== null || child.signalCode !== null) return;
    const ended = once(child, 'exit');
    child.kill(signal);
    await ended;
  };
  return { found, pid: child.pid, output: () => lines.join('\n'), end };
}

/** Returns {url, port, pid, output(), end()}. `port` 0 of a server's options: any. */
async function startServer(command, options) {
  const { found, pid, output, end } = await start(command, options, /http:\/\/127\.0\.0\.1:\d+/);
  return { url: `${found}/`, port: Number(new URL(found).port), pid, output, end };
}

export const startProgram = (program, board, port = 0, options = []) =>
  startServer(program, ['run', '--board', board, '--headless', '--pace', 'real', '--seed', '1', '--console', `127.0.0.1:${port}`, ...options]);

export const startSetup = (program, board, state, socket) => start(program, ['--board', board, '--state', state, '--socket', socket], /serves /);

export const startRehearsal = (options = {}, port = 0) =>
  startServer(process.execPath, [rehearsal, '--port', String(port), ...Object.entries(options).flatMap(([name, value]) => [`--${name}`, typeof value === 'string' ? value : JSON.stringify(value)])]);

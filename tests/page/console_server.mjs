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

/** Returns {url, end()}. `port` 0: any. Fails with the program's output if it ends before it prints the address. */
async function start(command, options) {
  const child = spawn(command, options, { stdio: ['ignore', 'pipe', 'pipe'] });
  children.add(child);
  child.on('exit', () => children.delete(child));
  const lines = [];
  const url = await new Promise((resolve, reject) => {
    for (const stream of [child.stdout, child.stderr]) {
      createInterface(stream).on('line', (line) => {
        lines.push(line);
        const address = /http:\/\/127\.0\.0\.1:\d+/.exec(line);
        if (address) resolve(`${address[0]}/`);
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
  return { url, port: Number(new URL(url).port), end };
}

export const startProgram = (program, board, port = 0) =>
  start(program, ['run', '--board', board, '--headless', '--pace', 'real', '--seed', '1', '--console', `127.0.0.1:${port}`]);

export const startRehearsal = (options = {}, port = 0) =>
  start(process.execPath, [rehearsal, '--port', String(port), ...Object.entries(options).flatMap(([name, value]) => [`--${name}`, typeof value === 'string' ? value : JSON.stringify(value)])]);

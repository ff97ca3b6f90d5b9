import { completeState } from './setup_defaults';
import type { FieldEntry, SetupCommand, SetupMessage, SetupPicture, SetupState } from './setup_protocol';
import { ANSWER_MS, whenSilent } from './silence';

// Every step has a few pictures, and clicks replace each other's.
const MAX_PICTURES = 48;

/** Sends a message; returns the number that the answer repeats, or 0 if there is no connection. */
type Send = (command: { type: 'setup' } & SetupCommand) => number;
interface Result {
  ok: boolean;
  error?: string;
  result?: unknown;
}

interface Ways {
  tells?: boolean; // false: nobody is told when it fails
  locks?: boolean; // false: the page stays usable meanwhile
}
export const SILENT: Ways = { tells: false, locks: false };

/** What the setup program said, and the commands to it. */
export class Setup {
  state = $state.raw<SetupState | null>(null);
  running = $state(false);
  pictures = $state.raw<ReadonlyMap<number, { url: string; image: ImageBitmap }>>(new Map());
  error = $state(''); // the answer to the last command, if it was refused
  waiting = $state(0); // commands without an answer
  fieldEntry = $state.raw<Partial<FieldEntry>>({}); // typed and not used yet; it stays while other steps are shown

  private answers = new Map<number, (answer: Result) => void>();

  constructor(private readonly send: Send) {}

  /** The result of a command, or null if it failed; then `error` says why. */
  async ask<T = unknown>(command: SetupCommand, { tells = true, locks = true }: Ways = {}): Promise<T | null> {
    if (tells) this.error = '';
    const number = this.send({ type: 'setup', ...command });
    if (number === 0) {
      if (tells) this.error = 'The page is not connected to the board. Nothing was sent.';
      return null;
    }
    if (locks) this.waiting += 1;
    const answer = await this.answerTo(number, command.command);
    if (locks) this.waiting -= 1;
    if (!answer.ok && tells) this.error = answer.error ?? 'The setup program refused this without a reason.';
    return answer.ok ? ((answer.result ?? {}) as T) : null;
  }

  private answerTo(number: number, command: string): Promise<Result> {
    return new Promise((resolve) => {
      const isBusy = () => this.state?.busy?.command === command;
      const endWatch = whenSilent(isBusy, () => {
        const error = `The setup program has not answered "${command}" for ${ANSWER_MS / 1000} s. Look whether it was done, and try again. If this happens again: systemctl restart touchline-setup`;
        this.accept({ to: number, ok: false, error });
      });
      this.answers.set(number, (answer) => {
        endWatch();
        resolve(answer);
      });
    });
  }

  /** Returns whether the answer was to a command of the setup. */
  accept(answer: { to: number } & Result): boolean {
    const resolve = this.answers.get(answer.to);
    this.answers.delete(answer.to);
    resolve?.(answer);
    return resolve !== undefined;
  }

  receive(message: SetupMessage): void {
    if (message.state) this.state = completeState(message.state);
  }

  async receivePicture({ id, content }: SetupPicture): Promise<void> {
    try {
      const image = await createImageBitmap(content);
      const next = new Map(this.pictures);
      this.release(next, id);
      next.set(id, { url: URL.createObjectURL(content), image });
      while (next.size > MAX_PICTURES) this.release(next, next.keys().next().value!);
      this.pictures = next;
    } catch {
      // A damaged picture is not shown.
    }
  }

  /** The connection is lost, or there is another setup program. */
  forget(): void {
    for (const resolve of this.answers.values()) resolve({ ok: false, error: 'The connection was lost before the answer came.' });
    this.answers.clear();
  }

  private release(pictures: Map<number, { url: string; image: ImageBitmap }>, id: number): void {
    const old = pictures.get(id);
    if (!old) return;
    URL.revokeObjectURL(old.url);
    old.image.close();
    pictures.delete(id);
  }
}

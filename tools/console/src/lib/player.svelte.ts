import { PixelMap } from './projection';
import { nextEvent, openRecording, readFrames, stepOf, type EventKind, type RecordedFrame, type Recording } from './recordings';
import type { Hello, State } from './protocol';
import type { Picture, Shown } from './shown';
import { Trails } from './trails';

// Frames that are loaded at once, and how many wait before more are loaded: two seconds and one at 30 pictures a second.
const BATCH = 60;
const ENOUGH = 30;
// A longer gap in the recording is skipped.
const GAP_MS = 1000;

/** Plays one recording: its pictures and results, as they were. */
export class Player implements Shown {
  recording = $state.raw<Recording | null>(null);
  frame = $state.raw<RecordedFrame | null>(null);
  picture = $state.raw<Picture | null>(null);
  playing = $state(false);
  speed = $state(1);
  problem = $state('');
  readonly trails = new Trails();
  readonly phase = 'open';
  readonly stale = false;

  number = $derived(this.frame?.number ?? 0);
  state = $derived<State | null>(this.frame?.state ?? null);
  /** Of the session that the frame belongs to. */
  private scene = $derived(this.recording?.scenes.filter(({ frame }) => frame <= this.number).at(-1) ?? this.recording?.scenes[0] ?? null);
  hello = $derived<Hello | null>(this.scene?.hello ?? null);
  pixelMap = $derived(this.hello?.projection ? new PixelMap(this.hello.projection) : null);

  private queue: RecordedFrame[] = []; // to be played, in their order
  private next = 0; // number of the frame to load after them
  private loading: AbortController | null = null;
  private turn = 0; // of what is shown: an older one that arrives later is dropped
  private animation = 0;
  private position_ms = 0;
  private before_ms = 0;

  async open(name: string): Promise<void> {
    this.close();
    try {
      this.recording = await openRecording(name);
      if (this.recording.frames > 0) await this.show(0);
      else this.problem = 'This recording has no frames.';
    } catch (error) {
      this.problem = (error as Error).message;
    }
  }

  close(): void {
    this.pause();
    this.turn += 1;
    this.setPicture(null);
    this.recording = null;
    this.frame = null;
    this.problem = '';
    this.trails.clear();
  }

  /** Shows this frame, and pauses. */
  async show(number: number): Promise<void> {
    this.pause();
    const { recording } = this;
    if (!recording) return;
    const wanted = Math.min(Math.max(Math.round(number), 0), recording.frames - 1);
    this.turn += 1;
    const { turn } = this;
    try {
      const [frame] = await readFrames(recording.name, wanted, 1, 1);
      if (frame && turn === this.turn) await this.present(frame);
    } catch (error) {
      if (turn === this.turn) this.problem = (error as Error).message;
    }
  }

  stepBy(frames: number): Promise<void> {
    return this.show(this.number + frames);
  }

  /** Shows the next event of these kinds; after the last one the first again. */
  async jump(kinds: readonly EventKind[]): Promise<void> {
    const event = nextEvent(this.recording?.events ?? [], kinds, this.number);
    if (event) await this.show(event.frame);
  }

  play(): void {
    const { recording } = this;
    if (!recording || this.playing) return;
    if (this.number >= recording.frames - 1) this.frame = null;
    this.playing = true;
    this.problem = '';
    this.queue = [];
    this.next = this.frame ? this.frame.number + 1 : 0;
    this.position_ms = this.frame?.at_ms ?? 0;
    this.before_ms = performance.now();
    this.animation = requestAnimationFrame((now) => this.tick(now));
  }

  pause(): void {
    this.playing = false;
    cancelAnimationFrame(this.animation);
    this.loading?.abort();
    this.loading = null;
    this.queue = [];
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    if (!this.playing) return;
    this.pause();
    this.play();
  }

  private tick(now_ms: number): void {
    const { recording } = this;
    if (!this.playing || !recording) return;
    this.position_ms += Math.min(now_ms - this.before_ms, 200) * this.speed;
    this.before_ms = now_ms;
    let due: RecordedFrame | null = null;
    while (this.queue[0] && this.queue[0].at_ms <= this.position_ms) due = this.queue.shift()!;
    const first = this.queue[0];
    if (!due && first && first.at_ms - this.position_ms > GAP_MS * this.speed) this.position_ms = first.at_ms;
    // While the disk or the link is slow, the time stands.
    if (!first) this.position_ms = Math.min(this.position_ms, due?.at_ms ?? this.frame?.at_ms ?? 0);
    if (due) void this.present(due);
    if (this.queue.length < ENOUGH && !this.loading && this.next < recording.frames) void this.load(recording);
    if (!first && !due && !this.loading && this.next >= recording.frames) return this.pause();
    this.animation = requestAnimationFrame((next_ms) => this.tick(next_ms));
  }

  private async load(recording: Recording): Promise<void> {
    const loading = (this.loading = new AbortController());
    const step = stepOf(recording.frames / Math.max(recording.duration_s, 1e-3), this.speed);
    try {
      const frames = await readFrames(recording.name, this.next, BATCH, step, loading.signal);
      if (this.loading !== loading) return;
      this.queue.push(...frames);
      this.next = (frames.at(-1)?.number ?? recording.frames) + step;
      // The last frame is shown, too.
      if (this.next >= recording.frames && this.next < recording.frames - 1 + step) this.next = recording.frames - 1;
      this.loading = null;
    } catch (error) {
      if (this.loading !== loading) return;
      this.pause();
      this.problem = (error as Error).message;
    }
  }

  private async present(frame: RecordedFrame): Promise<void> {
    this.turn += 1;
    const { turn } = this;
    let image: ImageBitmap;
    try {
      image = frame.jpeg ? await createImageBitmap(frame.jpeg) : await empty();
    } catch {
      image = await empty();
      this.problem = 'The picture of this frame is damaged.';
    }
    if (turn !== this.turn) return image.close();
    const before = this.frame;
    if (!before || frame.at_ms < before.at_ms || frame.at_ms - before.at_ms > GAP_MS) this.trails.clear();
    if (frame.state) this.trails.add(frame.state);
    this.frame = frame;
    if (frame.jpeg || frame.state) this.problem = '';
    else this.problem = 'This frame is damaged.';
    const header = { width_px: image.width, height_px: image.height, full_width_px: this.hello?.camera.width_px ?? image.width, number: frame.number, captured_s: frame.state?.captured_s ?? 0 };
    this.setPicture({ image, header, state: frame.state, findings: {} });
  }

  private setPicture(picture: Picture | null): void {
    this.picture?.image.close();
    this.picture = picture;
  }
}

/** In the place of a picture that was not recorded. */
function empty(): Promise<ImageBitmap> {
  const canvas = new OffscreenCanvas(4, 3);
  const context = canvas.getContext('2d')!;
  context.fillStyle = '#2a2f34';
  context.fillRect(0, 0, 4, 3);
  return createImageBitmap(canvas);
}

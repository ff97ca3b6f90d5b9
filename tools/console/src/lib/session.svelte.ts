import { Connection } from './connection';
import { paintClasses, paintLight } from './findings';
import { pageVersion } from './page_version';
import { PixelMap } from './projection';
import { PROTOCOL, type ArenaRequest, type ClientMessage, type Driver, type EventLine, type FindingsName, type Hello, type PictureHeader, type ProbeResult, type ServerMessage, type State, type Status } from './protocol';
import { Setup } from './setup.svelte';
import type { Findings, Picture } from './shown';
import { StopRequest } from './stop_request';
import { Trails } from './trails';

/** Values older than this are greyed. States arrive at least five times in this time. */
export const STALE_MS = 1200;
// A status comes every second. An older one does not say why robots are stopped: they may have been started since.
const STATUS_HALT_MS = 1800;
// The server sends its last 100 lines to every new client.
const MAX_EVENTS = 200;
const MAX_LATENCY_SAMPLES = 600;
// States that wait for their picture, which follows at once on the same link.
const MAX_WAITING_STATES = 30;
// Of a new frame in the mean of the stages' times: about two seconds at 15 Hz.
const STAGE_WEIGHT = 1 / 30;

export interface Notice {
  time_s: number | null;
  text: string;
}

/** Everything that the server said, for the pages to show. */
class Session {
  phase = $state<'connecting' | 'open' | 'lost'>('connecting');
  hello = $state.raw<Hello | null>(null);
  state = $state.raw<State | null>(null);
  status = $state.raw<Status | null>(null);
  picture = $state.raw<Picture | null>(null);
  events = $state.raw<EventLine[]>([]);
  driver = $state.raw<Driver>({ type: 'driver', driver: null, you: false });
  stop = $state.raw<{ request: StopRequest } | null>(null);
  problem = $state(''); // the server's answer to the last request that it refused
  lostReason = $state('');
  accessDenied = $state(false);
  serverProtocol = $state<number | null>(null); // of a server that this page cannot talk to
  newVersion = $state<string | null>(null); // the server was replaced since this page was loaded
  otherVersion = $state(false); // of the server, although page and server understand each other
  lostControl = $state(false); // this page had control when the link broke
  returned = $state<string | null>(null); // what happened while there was no connection
  clockDifference_s = $state<number | null>(null); // this device's clock minus the board's
  stages_ms = $state.raw<number[]>([]); // means of the last seconds
  now_ms = $state(performance.now());
  lost_ms = $state(0);
  retryAt_ms = $state(0);
  private lastData_ms = $state(-Infinity);
  private lastStatus_ms = $state(-Infinity);

  stale = $derived(this.phase !== 'open' || this.now_ms - this.lastData_ms > STALE_MS);
  /** Seconds since the last state arrived, by this device's steady clock. */
  silence_s = $derived(Math.max(0, (this.now_ms - this.lastData_ms) / 1000));
  statusStale = $derived(this.phase !== 'open' || this.now_ms - this.lastStatus_ms > 3000);
  /** The message that `halt` is from. */
  private newest = $derived.by((): State | Status | null => {
    if (this.state && !this.stale) return this.state;
    return this.phase === 'open' && this.now_ms - this.lastStatus_ms <= STATUS_HALT_MS ? this.status : null;
  });
  /** Why robots are stopped, [] if they may move; null: not known. Without frames the status tells it. */
  halt = $derived(this.newest?.halt ?? null);
  /** Whether a start ends at least one of the reasons in `halt`. */
  waitsForStart = $derived(this.newest?.waits_for_start ?? this.halt?.includes('console') ?? false);
  /** The saved files are not calibrated: nothing can be recognized until somebody sets the board up. */
  isBare = $derived(this.hello?.calibrated === false && this.hello.using !== 'draft');
  /** Devices that cannot be opened, with the reason. */
  lostDevices = $derived(this.statusStale ? [] : (this.status?.lost ?? []));
  pixelMap = $derived(this.hello?.projection ? new PixelMap(this.hello.projection) : null);

  readonly setup = new Setup((command) => this.connection.send(command));
  readonly trails = new Trails();
  /** p50 and p99 of the last minute, once per status. */
  readonly latencySamples: { time_s: number; p50_ms: number; p99_ms: number; max_ms: number }[] = [];

  private waiting = new Map<number, State>();
  private findings = new Map<number, Findings>(); // of pictures that follow
  private probes = new Map<number, (result: ProbeResult | null) => void>();
  private requests = new Map<number, string>();
  private deletions = new Map<number, (error: string) => void>();
  private decoding = false;
  private next: { header: PictureHeader; jpeg: Blob } | null = null;
  private wanted: Extract<ClientMessage, { type: 'watch' }> = { type: 'watch', picture: null, state_hz: 15, setup: false };
  private bootVersion: string | null = null;
  private readonly connection: Connection;
  /** For Stop alone: when a link loses packets, what waits to be sent again on one connection does not delay the other. */
  private readonly stopLine: Connection;
  private stopOnLine = 0; // number of the last stop there

  constructor() {
    const url = new URL('ws', location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    url.hash = '';
    this.connection = new Connection(url.href, {
      opened: () => this.opened(),
      lost: (reason, retryInMs) => this.lost(reason, retryInMs),
      message: (message) => this.receive(message),
      picture: (header, jpeg) => this.receivePicture(header, jpeg),
      valueGrid: ({ name, number, grid }) => this.keepFindings(number, name === 'classes' ? { classes: paintClasses(grid, this.hello?.classes.map(({ rgb }) => rgb) ?? []), classesGrid: grid } : { light: paintLight(grid), lightGrid: grid }),
      setupPicture: (received) => void this.setup.receivePicture(received),
    });
    const ignore = () => {};
    this.stopLine = new Connection(
      url.href,
      { opened: ignore, lost: ignore, message: (message) => this.receiveOnStopLine(message), picture: ignore, valueGrid: ignore, setupPicture: ignore },
      (address) => new WebSocket(address, 'touchline.stop.1'),
    );
  }

  start(): void {
    this.connection.open();
    // Before the server says what it can: it has places for Stop, also when it has none for another page.
    this.stopLine.open();
    setInterval(() => (this.now_ms = performance.now()), 200);
    // Robots stop when the driver is silent for a second.
    setInterval(() => this.driver.you && this.connection.tell({ type: 'ping' }), 300);
    // The answer shows that the line is alive.
    setInterval(() => this.stopLine.send({ type: 'ping' }), 1000);
    addEventListener('online', () => this.phase !== 'open' && this.connection.open());
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden && this.phase === 'lost') this.connection.open();
      this.sendWatch();
    });
  }

  retryNow(): void {
    this.connection.open();
  }

  /** What this page shows: a picture of at most this width, or none. */
  watch(picture: { rate_hz: number; max_width_px: number } | null, findings: FindingsName[] = []): void {
    if (!picture) this.setPicture(null);
    this.want({ ...this.wanted, picture, findings });
  }

  /** What the camera sees at this pixel of its full picture; null: unknown. */
  probe(u: number, v: number): Promise<ProbeResult | null> {
    const number = this.connection.send({ type: 'probe', u_px: Math.max(0, u), v_px: Math.max(0, v) });
    if (number <= 0) return Promise.resolve(null);
    return new Promise((resolve) => this.probes.set(number, resolve));
  }

  tellScore(own: number, opponent: number): void {
    this.ask({ type: 'score', own, opponent }, 'Score');
  }

  /** Whether this page shows the setup. */
  watchSetup(setup: boolean): void {
    this.want({ ...this.wanted, setup });
  }

  private want(wanted: Extract<ClientMessage, { type: 'watch' }>): void {
    if (JSON.stringify(wanted) === JSON.stringify(this.wanted)) return;
    this.wanted = wanted;
    this.sendWatch();
  }

  requestStop(): void {
    const request = new StopRequest(this.state?.number ?? -1, performance.now());
    request.passed(this.connection.send({ type: 'stop' }));
    this.stopOnLine = this.stopLine.send({ type: 'stop' });
    this.stop = { request };
  }

  requestStart(): void {
    // Of the stop that this page shows. Another one that has come since stays.
    const stop_number = this.newest?.stop_number;
    if (stop_number === undefined) {
      this.problem = 'Start: the page does not know yet why the robots are stopped. Wait for data from the board.';
      return;
    }
    this.stop = null;
    this.ask({ type: 'start', stop_number }, 'Start');
  }

  takeControl(): void {
    this.ask({ type: 'take' }, 'Take control');
  }

  /** Returns whether this page has control, after the server has said so. */
  async takeControlNow(): Promise<boolean> {
    this.takeControl();
    for (let waited_ms = 0; !this.driver.you && waited_ms < 5000 && !this.problem; waited_ms += 50) await new Promise((resolve) => setTimeout(resolve, 50));
    return this.driver.you;
  }

  releaseControl(): void {
    this.ask({ type: 'release' }, 'Give up control');
  }

  adapt(action: 'freeze' | 'follow' | 'reset'): void {
    this.ask({ type: 'adaptation', action }, 'Adaptation to the light');
  }

  /** Moves the robot or the ball of the arena that the camera's picture shows at `from`. */
  moveObject(from: [number, number], to: [number, number]): void {
    const [u_px, v_px, to_u_px, to_v_px] = [...from, ...to].map((value) => Math.max(0, value)) as [number, number, number, number];
    this.ask({ type: 'move', u_px, v_px, to_u_px, to_v_px }, 'Move');
  }

  /** Stops the arena's time, lets it pass, or begins its game anew. */
  controlArena(request: ArenaRequest, what: string): void {
    this.ask({ type: 'arena', do: request }, what);
  }

  /** Begins or ends a recording. */
  record(on: boolean): void {
    this.ask({ type: 'recording', action: on ? 'start' : 'stop' }, 'Recording');
  }

  /** Returns the server's error, or "". */
  deleteRecording(name: string): Promise<string> {
    const number = this.connection.send({ type: 'recording', action: 'delete', name });
    if (number <= 0) return Promise.resolve('no connection');
    return new Promise((resolve) => this.deletions.set(number, resolve));
  }

  tell(message: ClientMessage): void {
    this.connection.tell(message);
  }

  private ask(message: ClientMessage, what: string): void {
    this.problem = '';
    const number = this.connection.send(message);
    if (number > 0) this.requests.set(number, what);
    else this.problem = `${what}: no connection.`;
  }

  private sendWatch(): void {
    // A page in the background needs to know halts only.
    this.connection.tell(document.hidden ? { type: 'watch', picture: null, state_hz: 2 } : this.wanted);
  }

  private opened(): void {
    this.accessDenied = false;
    this.sendWatch();
  }

  private lost(reason: string, retryInMs: number): void {
    this.lostReason = reason;
    this.retryAt_ms = performance.now() + retryInMs;
    if (this.phase === 'open') this.lost_ms = performance.now();
    if (this.phase !== 'lost') {
      this.lostControl = this.driver.you;
      this.driver = { type: 'driver', driver: null, you: false };
      this.requests.clear();
      for (const resolve of this.probes.values()) resolve(null);
      this.probes.clear();
      for (const resolve of this.deletions.values()) resolve('the connection was lost');
      this.deletions.clear();
      this.setup.forget();
      this.phase = this.hello ? 'lost' : 'connecting';
    }
    this.checkAccess();
  }

  /** The browser does not tell why a WebSocket was refused; a plain request does. */
  private async checkAccess(): Promise<void> {
    try {
      const answer = await fetch('.', { method: 'HEAD', cache: 'no-store' });
      this.accessDenied = answer.status === 401 || answer.status === 403;
    } catch {
      this.accessDenied = false;
    }
  }

  private receive(message: ServerMessage): void {
    if (message.type === 'hello') return this.receiveHello(message);
    if (this.serverProtocol !== null) return;
    switch (message.type) {
      case 'state':
        return this.receiveState(message);
      case 'status':
        this.status = message;
        this.lastStatus_ms = this.now_ms = performance.now();
        this.latencySamples.push({
          time_s: message.time_s,
          p50_ms: message.latency.minute.p50_ms,
          p99_ms: message.latency.minute.p99_ms,
          max_ms: message.latency.minute.max_ms,
        });
        if (this.stop) {
          const before = this.stop.request.confirmed;
          this.stop.request.acceptStatus(message.halt);
          // Released by somebody else.
          if (before && this.stale && message.halt && !message.halt.includes('console')) this.stop = null;
          else if (before !== this.stop.request.confirmed) this.stop = { request: this.stop.request };
        }
        if (this.latencySamples.length > MAX_LATENCY_SAMPLES) this.latencySamples.shift();
        return;
      case 'event':
        this.events = [...this.events, message].slice(-MAX_EVENTS);
        return;
      case 'driver':
        this.driver = message;
        return;
      case 'setup_program':
        this.setup.running = message.running;
        if (!message.running) this.setup.forget();
        return;
      case 'setup':
        this.setup.receive(message);
        return;
      case 'regions':
        this.keepFindings(message.number, { regions: message });
        return;
      case 'answer': {
        const probe = this.probes.get(message.to);
        if (probe) {
          this.probes.delete(message.to);
          return probe(message.ok ? ((message.result as ProbeResult | undefined) ?? null) : null);
        }
        const deletion = this.deletions.get(message.to);
        if (deletion) {
          this.deletions.delete(message.to);
          return deletion(message.ok ? '' : (message.error ?? 'refused'));
        }
        if (this.setup.accept(message)) return;
        if (message.ok && this.stop?.request.number === message.to) this.stop.request.answered = true;
        const what = this.requests.get(message.to);
        this.requests.delete(message.to);
        if (!message.ok && what) this.problem = `${what}: ${message.error ?? 'refused'}`;
        return;
      }
    }
  }

  private receiveOnStopLine(message: ServerMessage): void {
    if (message.type !== 'answer' || !message.ok || !this.stop || message.to !== this.stopOnLine) return;
    this.stop.request.answered = true;
    this.stop = { request: this.stop.request };
  }

  private receiveHello(hello: Hello): void {
    if (hello.protocol !== PROTOCOL) {
      this.serverProtocol = hello.protocol;
      this.forget();
      this.hello = null;
      this.phase = 'open';
      return;
    }
    this.serverProtocol = null;
    if (this.bootVersion !== null && this.bootVersion !== hello.version) this.newVersion = hello.version;
    this.bootVersion ??= hello.version;
    if (!hello.stop_line) this.stopLine.close();
    if (this.phase === 'lost') {
      const gap_s = (performance.now() - this.lost_ms) / 1000;
      this.returned = `The connection is back after ${gap_s < 1 ? 'less than a second' : `${Math.round(gap_s)} s`}.${this.lostControl ? ' The robots were stopped, because this page had control. Take control again to start them.' : ''}`;
    }
    if (hello.time_s !== undefined) this.clockDifference_s = Date.now() / 1000 - hello.time_s;
    // On the same connection: the firmware runs with other files now, and does not repeat its events.
    this.forget(this.phase === 'open');
    this.hello = hello;
    this.setup.running = hello.setup ?? false;
    this.otherVersion = hello.version !== pageVersion;
    this.phase = 'open';
    // A stop that was not confirmed before the link broke is still wanted.
    if (this.stop && !this.stop.request.confirmed) {
      this.stop.request.restart();
      this.stop.request.passed(this.connection.send({ type: 'stop' }));
    }
  }

  private forget(keepEvents = false): void {
    this.waiting.clear();
    this.findings.clear();
    this.trails.clear();
    if (!keepEvents) this.events = [];
    this.state = null;
    this.status = null;
    this.latencySamples.length = 0;
    this.stages_ms = [];
    this.next = null;
    this.setPicture(null);
  }

  private receiveState(state: State): void {
    this.state = state;
    this.lastData_ms = this.now_ms = performance.now();
    this.trails.add(state);
    this.stages_ms = (state.stages_ms ?? []).map((value, i) => {
      const mean = this.stages_ms[i] ?? value;
      return mean + STAGE_WEIGHT * (value - mean);
    });
    this.waiting.set(state.number, state);
    if (this.waiting.size > MAX_WAITING_STATES) this.waiting.delete(this.waiting.keys().next().value!);
    if (this.stop) {
      const before = this.stop.request.confirmed;
      this.stop.request.accept(state);
      // Released by somebody else.
      if (before && !state.halt.includes('console')) this.stop = null;
      else if (before !== this.stop.request.confirmed) this.stop = { request: this.stop.request };
    }
  }

  private keepFindings(number: number, part: Findings): void {
    this.findings.set(number, { ...this.findings.get(number), ...part });
    // Of earlier pictures that were never sent.
    for (const known of this.findings.keys()) if (known < number - MAX_WAITING_STATES) this.findings.delete(known);
  }

  private receivePicture(header: PictureHeader, jpeg: Blob): void {
    if (this.serverProtocol !== null) return;
    // At once: the server measures the link with it, not how busy this device is. Of pictures that wait, the newest is shown.
    this.connection.tell({ type: 'seen', number: header.number });
    this.next = { header, jpeg };
    if (!this.decoding) void this.decode();
  }

  private async decode(): Promise<void> {
    this.decoding = true;
    while (this.next) {
      const { header, jpeg } = this.next;
      this.next = null;
      try {
        const image = await createImageBitmap(jpeg);
        if (this.wanted.picture && this.phase === 'open') this.setPicture({ image, header, state: this.waiting.get(header.number) ?? null, findings: this.findings.get(header.number) ?? {} });
        else image.close();
      } catch {
        // A damaged picture; the next one replaces it.
      }
    }
    this.decoding = false;
  }

  private setPicture(picture: Picture | null): void {
    this.picture?.image.close();
    this.picture = picture;
  }
}

export const session = new Session();

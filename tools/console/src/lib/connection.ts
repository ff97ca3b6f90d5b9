import { BINARY_HEADER_BYTES, readMessage, readPictureHeader, readSetupPicture, readValueGrid, type ClientMessage, type PictureHeader, type ServerMessage } from './protocol';
import type { SetupPicture } from './setup_protocol';

/** Delays between two attempts to connect; the last one repeats. */
export const RETRY_DELAYS_MS = [250, 500, 1000, 2000, 4000];
/** Status arrives every second. A link that is silent for this long is dead, whatever the system says about it. */
export const SILENCE_MS = 4000;

export interface Handlers {
  opened(): void;
  /** `reason`: the server's words, or empty. Called once for each loss and for each failed attempt. */
  lost(reason: string, retryInMs: number): void;
  message(message: ServerMessage): void;
  picture(header: PictureHeader, jpeg: Blob): void;
  setupPicture(picture: SetupPicture): void;
  valueGrid(received: NonNullable<ReturnType<typeof readValueGrid>>): void;
}

/** A socket that connects again by itself until close(). */
export class Connection {
  private socket: WebSocket | null = null;
  private attempts = 0;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private silenceTimer: ReturnType<typeof setTimeout> | undefined;
  private closed = false;
  private request = 0;

  constructor(
    private readonly url: string,
    private readonly handlers: Handlers,
    private readonly makeSocket: (url: string) => WebSocket = (url) => new WebSocket(url, 'touchline.1'),
  ) {}

  open(): void {
    clearTimeout(this.retryTimer);
    this.abandon();
    this.closed = false;
    const socket = this.makeSocket(this.url);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    this.expectMessage();
    socket.onopen = () => this.handlers.opened();
    socket.onmessage = (event: MessageEvent) => {
      this.expectMessage();
      if (typeof event.data === 'string') {
        const message = readMessage(event.data);
        if (!message) return;
        // A server that refuses at once would otherwise be asked four times a second.
        if (message.type === 'hello') this.attempts = 0;
        this.handlers.message(message);
      } else {
        const data = event.data as ArrayBuffer;
        const header = readPictureHeader(data);
        if (header) return this.handlers.picture(header, new Blob([data.slice(BINARY_HEADER_BYTES)], { type: 'image/jpeg' }));
        const setupPicture = readSetupPicture(data);
        if (setupPicture) return this.handlers.setupPicture(setupPicture);
        const received = readValueGrid(data);
        if (received) this.handlers.valueGrid(received);
      }
    };
    socket.onclose = (event: CloseEvent) => this.retry(event.reason);
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.retryTimer);
    this.abandon();
  }

  get isOpen(): boolean {
    return this.socket?.readyState === 1;
  }

  /** Returns the number that the answer repeats, or 0 if there is no connection. */
  send(message: ClientMessage): number {
    if (!this.socket || !this.isOpen) return 0;
    this.request += 1;
    this.socket.send(JSON.stringify({ ...message, request: this.request }));
    return this.request;
  }

  /** Sends a message that needs no answer. */
  tell(message: ClientMessage): void {
    if (this.socket && this.isOpen) this.socket.send(JSON.stringify(message));
  }

  private expectMessage(): void {
    clearTimeout(this.silenceTimer);
    this.silenceTimer = setTimeout(() => {
      this.abandon();
      this.retry('');
    }, SILENCE_MS);
  }

  /** Closing a dead link takes long; its events no longer count. */
  private abandon(): void {
    clearTimeout(this.silenceTimer);
    const socket = this.socket;
    this.socket = null;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }

  private retry(reason: string): void {
    clearTimeout(this.silenceTimer);
    if (this.closed) return;
    this.socket = null;
    const delay = RETRY_DELAYS_MS[Math.min(this.attempts, RETRY_DELAYS_MS.length - 1)] ?? 4000;
    this.attempts += 1;
    clearTimeout(this.retryTimer);
    this.retryTimer = setTimeout(() => this.open(), delay);
    this.handlers.lost(reason, delay);
  }
}

/** Live telemetry over the service's WebSocket; survives restarts of the service and sleeping laptops. */
import { socketAddress } from "../api/address";
import type { History, MissionEvent, MissionSnapshot } from "../api/types";
import { waitBefore } from "./backoff";
import type { Table } from "./columns";
import { samplesOfTable, type Sample } from "./quantities";
import type { Sink, Source } from "./source";

/** Milliseconds between two looks whether anything has come. */
const CHECK_PERIOD = 250;
/** An open socket on which nothing came between so many looks is dead. Looks are counted and not time, so that a
 * browser that was itself held up does not take its own pause for the service's. */
const SILENT_CHECKS = 12;
/** Mission time between two snapshots beyond which the history is asked for what lay between. */
const GAP = 0.1;
/** Milliseconds between two such questions. */
const BACKFILL_PERIOD = 500;

type Frame =
  | { type: "hello"; service: string; service_time: number }
  | { type: "preparing" }
  | { type: "missed" }
  | ({ type: "history"; run_id: string } & Table)
  | ({ type: "snapshot" } & MissionSnapshot)
  | ({ type: "event" } & MissionEvent)
  | { type: "reset"; run_id: string };

/** What is known of a run before its first snapshot: until then the page shows the one before it, whole. */
interface Coming {
  readonly run: string;
  readonly events: MissionEvent[];
  history: readonly Sample[] | null;
}

/** The part of a WebSocket that is needed here. */
export interface Socket {
  onopen: (() => void) | null;
  onclose: (() => void) | null;
  onmessage: ((message: { data: unknown }) => void) | null;
  send(text: string): void;
  close(): void;
}

export interface LiveSourceOptions {
  readonly connect: () => Socket;
  readonly readHistory: (since: number) => Promise<History>;
}

export class LiveSource implements Source {
  constructor(private readonly options: LiveSourceOptions) {}

  open(sink: Sink): () => void {
    const connection = new Connection(this.options, sink);
    connection.start();
    return () => {
      connection.end();
    };
  }
}

class Connection {
  private socket: Socket | null = null;
  private attempt = 0;
  /** The run whose mission is told. */
  private run = "";
  private coming: Coming | null = null;
  private ended = false;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private watchdog: ReturnType<typeof setInterval> | undefined;
  private silentChecks = 0;
  /** Of the newest snapshot, on the service's clock. */
  private shownUntil = -Infinity;
  private lastTime = Number.NaN;
  private gapSince: number | null = null;
  private lastTick = -1;
  private lastBackfillAt = 0;

  constructor(
    private readonly options: LiveSourceOptions,
    private readonly sink: Sink,
  ) {}

  start(): void {
    this.sink.link({ state: "connecting" });
    this.connect();
    this.watchdog = setInterval(() => {
      this.check();
    }, CHECK_PERIOD);
  }

  end(): void {
    this.ended = true;
    clearInterval(this.watchdog);
    clearTimeout(this.retry);
    this.drop();
  }

  private connect(): void {
    const socket = this.options.connect();
    this.socket = socket;
    this.silentChecks = 0;
    socket.onopen = () => {
      this.attempt = 0;
      this.lastTime = Number.NaN;
      this.shownUntil = -Infinity; // another service may have another clock
      this.coming = null;
      this.sink.link({ state: "open" });
    };
    socket.onmessage = (message) => {
      if (typeof message.data === "string") this.take(JSON.parse(message.data) as Frame);
    };
    socket.onclose = () => {
      this.lost();
    };
  }

  /** A closed or silent connection: tell, and try again after a while. */
  private lost(): void {
    this.drop();
    if (this.ended) return;
    this.attempt += 1;
    const wait = waitBefore(this.attempt);
    this.sink.link({ state: "lost", attempt: this.attempt, retryAt: performance.now() + wait });
    this.retry = setTimeout(() => {
      this.connect();
    }, wait);
  }

  private drop(): void {
    const socket = this.socket;
    this.socket = null;
    if (socket === null) return;
    socket.onopen = socket.onclose = socket.onmessage = null;
    socket.close();
  }

  private check(): void {
    if (this.socket === null) return;
    this.silentChecks += 1;
    if (this.silentChecks > SILENT_CHECKS) this.lost();
  }

  private take(frame: Frame): void {
    this.silentChecks = 0;
    switch (frame.type) {
      case "snapshot":
        this.takeSnapshot(frame);
        break;
      case "event":
        if (this.coming === null) this.sink.event(frame);
        else this.coming.events.push(frame);
        break;
      case "missed":
        this.sink.missed();
        break;
      case "history":
        if (frame.run_id === this.run) this.sink.history(samplesOfTable(frame));
        else this.coming = { run: frame.run_id, events: [], history: samplesOfTable(frame) };
        break;
      case "reset":
        this.coming = { run: frame.run_id, events: [], history: null };
        break;
      case "hello":
        this.sink.heard(frame.service, frame.service_time);
        break;
      case "preparing":
        break;
    }
  }

  /** Nothing older than what was shown is shown any more, also not of a run that another one has followed. */
  private takeSnapshot(snapshot: MissionSnapshot): void {
    this.socket?.send(JSON.stringify({ type: "ack", tick: snapshot.tick }));
    if (snapshot.service_time <= this.shownUntil) return;
    if (this.coming !== null && snapshot.run_id === this.run && this.coming.run !== this.run) return;
    this.shownUntil = snapshot.service_time;
    if (snapshot.run_id !== this.run) this.begin(snapshot.run_id);
    this.sink.snapshot(snapshot);
    this.noticeGap(snapshot);
  }

  /** Shows another run, with all that came of it before its first snapshot. */
  private begin(run: string): void {
    if (this.run !== "") this.sink.reset();
    const coming = this.coming?.run === run ? this.coming : null;
    this.run = run;
    this.coming = null;
    // Without a history what lies before is asked for: a fork begins in the middle.
    this.lastTime = coming?.history ? Number.NaN : 0;
    this.lastTick = -1;
    this.gapSince = null;
    if (coming?.history) this.sink.history(coming.history);
    for (const event of coming?.events ?? []) this.sink.event(event);
  }

  /** Dropped frames, a sleeping tab or a simulation much faster than real time leave holes that the history fills. */
  private noticeGap(snapshot: MissionSnapshot): void {
    if (snapshot.time - this.lastTime > GAP) this.gapSince ??= this.lastTick;
    this.lastTime = snapshot.time;
    this.lastTick = snapshot.tick;
    const now = performance.now();
    if (this.gapSince === null || now - this.lastBackfillAt < BACKFILL_PERIOD) return;
    this.lastBackfillAt = now;
    const since = this.gapSince;
    const run = this.run;
    this.gapSince = null;
    this.options.readHistory(since).then(
      (history) => {
        if (history.run_id === this.run) this.sink.history(samplesOfTable(history));
      },
      () => {
        if (run === this.run) this.gapSince ??= since;
      },
    );
  }
}


/** The service's telemetry socket, at up to that many snapshots a second. */
export function telemetrySocket(rate: number): Socket {
  return new WebSocket(socketAddress(`/api/v1/telemetry?rate=${rate}`)) as Socket;
}

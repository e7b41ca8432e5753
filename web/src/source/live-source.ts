/** Live telemetry over the service's WebSocket; survives restarts of the service and sleeping laptops. */
import { addressOf, socketAddress } from "../api/address";
import { changeScene, readEvents, readHistory, readScene, readTicks } from "../api/service";
import type { Alarm, MissionEvent, MissionSnapshot } from "../api/types";
import { waitBefore } from "./backoff";
import type { Table } from "./columns";
import { samplesOfTable, type Sample } from "./quantities";
import { readFinely } from "./read-finely";
import type { CutOff, Range, SceneArrangement, Sink, Source } from "./source";

/** Snapshots a second at most; of a mission at rest, whose readings stand still; and to a page that nobody looks at. */
const RATE = 60;
const RATE_AT_REST = 10;
const RATE_UNSEEN = 4;
const AT_REST: ReadonlySet<string> = new Set(["idle", "stopped", "faulted"]);
const SCENE = addressOf("/scene/");

/** Milliseconds between two looks whether anything has come. */
const CHECK_PERIOD = 250;
/** An open socket on which nothing came between so many looks is dead. Looks are counted and not time, so that a
 * browser that was itself held up does not take its own pause for the service's. */
const SILENT_CHECKS = 12;
/** Mission time between two snapshots beyond which the history is asked for what lay between. */
const GAP = 0.1;
/** Milliseconds between two such questions. */
const BACKFILL_PERIOD = 500;
/** Milliseconds between two looks at the extremes of what was left out. */
const EXTREMES_PERIOD = 5000;
/** Rows told from which on the whole history is asked for again: it is shorter and has every extreme. */
const MANY = 10_000;
/** Seconds behind the newest tick within which a run in progress may not be on disk yet. */
const ON_DISK = 2;

type Frame =
  | { type: "hello"; service: string; service_time: number; cut_off: CutOff | null }
  | { type: "preparing" }
  | { type: "missed" }
  | { type: "alarms"; alarms: Alarm[] }
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
  /** Whether anybody can see the page. */
  readonly isSeen: () => boolean;
  readonly readHistory: typeof readHistory;
  readonly readEvents: typeof readEvents;
  readonly readTicks: typeof readTicks;
}

/** The service's telemetry socket. */
const connect = (): Socket => new WebSocket(socketAddress(`/api/v1/telemetry?rate=${RATE}`)) as Socket;

const SERVICE: LiveSourceOptions = { connect, isSeen: () => !document.hidden, readHistory, readEvents, readTicks };

export class LiveSource implements Source {
  readonly playback = null;
  readonly takePicture = null;
  readonly refreshPeriod = EXTREMES_PERIOD;
  readonly scene: SceneArrangement = {
    changeNeeds: "operator",
    read: readScene,
    change: async (change) => {
      await changeScene(change);
    },
  };
  private readonly options: LiveSourceOptions;
  private connection: Connection | null = null;

  constructor(options: Partial<LiveSourceOptions> = {}) {
    this.options = { ...SERVICE, ...options };
  }

  open(sink: Sink): () => void {
    const connection = new Connection(this.options, sink);
    this.connection = connection;
    connection.start();
    return () => {
      connection.end();
      this.connection = null;
    };
  }

  /** Puts the extremes of every piece of time in place of the snapshots, which leave ticks out. */
  async refresh(): Promise<void> {
    await this.connection?.takeExtremes();
  }

  /** Of the run on disk, which is a little behind. */
  async readRange(range: Range): Promise<readonly Sample[] | null> {
    const { run, lastTime } = this.connection ?? { run: "", lastTime: Number.NaN };
    return run !== "" && range.to < lastTime - ON_DISK ? readFinely(this.options.readTicks, run, range) : null;
  }
}

class Connection {
  private socket: Socket | null = null;
  private attempt = 0;
  /** The run whose mission is told. */
  run = "";
  private coming: Coming | null = null;
  private ended = false;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private watchdog: ReturnType<typeof setInterval> | undefined;
  private silentChecks = 0;
  /** Of the newest snapshot, on the service's clock. */
  private shownUntil = -Infinity;
  /** Mission time of the newest snapshot; NaN before the first one of a connection. */
  lastTime = Number.NaN;
  private gapSince: number | null = null;
  /** Snapshots a second that were asked for. */
  private rate = RATE;
  private lastTick = -1;
  private lastBackfillAt = 0;
  /** Whether the library may know events that were not sent: of a page that joined late, or missed some. */
  private eventsMissing = true;
  /** Rows told since the whole history was, and the last tick whose extremes are known. */
  private rows = 0;
  private extremesUntil = -1;

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
      this.rate = RATE;
      this.lastTime = Number.NaN;
      this.shownUntil = -Infinity; // another service may have another clock
      this.coming = null;
      this.eventsMissing = true;
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

  /** Asks for as many snapshots as are of use. */
  private askForRate(phase: string): void {
    const wanted = this.options.isSeen() ? (AT_REST.has(phase) ? RATE_AT_REST : RATE) : RATE_UNSEEN;
    if (wanted === this.rate) return;
    this.rate = wanted;
    this.socket?.send(JSON.stringify({ type: "rate", rate: wanted }));
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
        if (this.coming === null) this.sink.events([frame]);
        else this.coming.events.push(frame);
        break;
      case "alarms":
        this.sink.alarms(frame.alarms);
        break;
      case "missed":
        this.eventsMissing = true;
        break;
      case "history":
        if (frame.run_id === this.run) this.sink.history(samplesOfTable(frame));
        else this.coming = { run: frame.run_id, events: [], history: samplesOfTable(frame) };
        break;
      case "reset":
        this.coming = { run: frame.run_id, events: [], history: null };
        break;
      case "hello":
        this.sink.hello(frame.service, frame.service_time, frame.cut_off);
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
    this.sink.touches(snapshot.contacts);
    this.sink.snapshot(snapshot);
    this.rows += 1;
    this.askForRate(snapshot.phase);
    this.noticeGap(snapshot);
    if (this.eventsMissing) this.askForEvents();
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
    this.rows = 0;
    this.extremesUntil = -1;
    this.eventsMissing = true;
    this.sink.run({ id: run, title: `Run ${run}, in progress` });
    this.sink.scene(SCENE);
    if (coming?.history) this.sink.history(coming.history);
    this.sink.events(coming?.events ?? []);
  }

  /** Reads what the library has; if it does not answer, the next connection asks again. */
  private askForEvents(): void {
    const run = this.run;
    this.eventsMissing = false;
    this.options.readEvents(run).then(
      (events) => {
        if (run === this.run) this.sink.events(events);
      },
      () => undefined,
    );
  }

  /** @throws Refusal */
  async takeExtremes(): Promise<void> {
    if (this.run === "") return;
    const since = this.rows > MANY || this.extremesUntil > this.lastTick ? -1 : this.extremesUntil;
    const history = await this.options.readHistory(since);
    // A reset meanwhile: this is the history of another mission than the one that is shown.
    if (history.run_id !== this.run) return;
    const samples = samplesOfTable(history);
    this.rows = since === -1 ? samples.length : this.rows + samples.length;
    this.extremesUntil = samples.at(-1)?.tick ?? this.extremesUntil;
    this.sink.history(samples);
  }

  /** Dropped frames, a sleeping tab or a simulation much faster than real time leave holes that the history fills. */
  private noticeGap(snapshot: MissionSnapshot): void {
    const atRest = AT_REST.has(snapshot.phase);
    if (snapshot.time - this.lastTime > GAP && !atRest) this.gapSince ??= this.lastTick;
    this.lastTime = snapshot.time;
    this.lastTick = snapshot.tick;
    const now = performance.now();
    if (this.gapSince === null || now - this.lastBackfillAt < BACKFILL_PERIOD || !this.options.isSeen()) return;
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

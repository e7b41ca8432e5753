/** What the console knows of a mission, live or stored: one immutable view for the panels, one series for the plots. */
import type { Alarm, Health, MissionEvent, MissionSnapshot, Touch } from "../api/types";
import { replaceEqualDeep } from "@tanstack/react-query";
import { sampleOfSnapshot, type Sample } from "../source/quantities";
import { Series } from "../source/series";
import { ServiceClock } from "../source/service-clock";
import type { Config, CutOff, Link, ShownRun, Sink, Source } from "../source/source";

/** Age at which what is shown counts as old, in milliseconds: since the service made it, not since it came. */
export const STALE_AFTER = 500;
/** The panels follow at this pace; plots read the series at theirs. Milliseconds. */
const PUBLISH_PERIOD = 100;
const EVENTS_KEPT = 500;
/** A browser that was itself held up has frames waiting; this many looks without one are silence. */
const SILENT_CHECKS = 3;

/**
 * How much of what is on the screen may be trusted.
 *
 * `connecting`: nothing has come yet; `preparing`: the service is there but its controller is being compiled;
 * `live`: it is as it should be, and a stored run always is; `stale`: the newest snapshot is older than `STALE_AFTER`,
 * or the connection is lost.
 */
export type Trust = "connecting" | "preparing" | "live" | "stale";

export interface MissionView {
  readonly run: ShownRun | null;
  readonly config: Config | null;
  readonly snapshot: MissionSnapshot | null;
  readonly touches: readonly Touch[];
  readonly events: readonly MissionEvent[];
  readonly alarms: readonly Alarm[];
  /** The address of the scene's page. */
  readonly scene: string | null;
  /** Why snapshots and scene come no more; null while they do. */
  readonly ended: string | null;
  readonly link: Link;
  readonly trust: Trust;
  /** How often the connection was made. */
  readonly connections: number;
  /** Milliseconds since the service made what is shown; steps of a tenth of a second while stale, else 0. */
  readonly age: number;
  /** Milliseconds since the robot reported what is shown of it; likewise, and 0 in simulation. */
  readonly robotAge: number;
  /** Milliseconds to the next attempt to connect, rounded up to seconds; 0 if none is planned. */
  readonly retryIn: number;
  /** Null once it has been read, or if there was none. */
  readonly cutOff: CutOff | null;
  readonly health: Health | null;
  /** How long the service took to say so, milliseconds; null without an answer. */
  readonly answerTime: number | null;
  /** When the service was first known to be preparing, on the clock of `performance.now()`. */
  readonly preparingSince: number | null;
}

const NOTHING: MissionView = {
  run: null,
  config: null,
  snapshot: null,
  touches: [],
  events: [],
  alarms: [],
  scene: null,
  ended: null,
  link: { state: "connecting" },
  trust: "connecting",
  connections: 0,
  age: 0,
  robotAge: 0,
  retryIn: 0,
  cutOff: null,
  health: null,
  answerTime: null,
  preparingSince: null,
};

type Listener = () => void;

export class MissionStore implements Sink {
  readonly series = new Series();
  private view = NOTHING;
  private pending: Partial<MissionView> = {};
  private readonly clock = new ServiceClock();
  private publishedAt = -Infinity;
  private silentChecks = 0;
  private service = "";
  private readonly listeners = new Set<Listener>();

  constructor(
    readonly source: Source,
    private readonly now: () => number = () => performance.now(),
  ) {}

  /** Has the source tell; the returned function ends it. */
  readonly open = (): (() => void) => this.source.open(this);

  readonly subscribe = (listener: Listener): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  readonly read = (): MissionView => this.view;

  run(run: ShownRun): void {
    this.change({ run }, true);
  }

  config(config: Config): void {
    this.change({ config }, true);
  }

  snapshot(snapshot: MissionSnapshot): void {
    const now = this.now();
    this.clock.arrived(snapshot.service_time, now);
    if (this.clock.age(snapshot.service_time, now) <= STALE_AFTER) this.silentChecks = 0;
    this.series.append(sampleOfSnapshot(snapshot));
    const before = this.pending.snapshot ?? this.view.snapshot;
    const changed = before?.phase !== snapshot.phase || (before.outcome === null) !== (snapshot.outcome === null);
    // Nobody looks at the clock of a stored run, which would publish what waits.
    this.change({ snapshot }, changed || this.view.trust !== "live" || this.view.link.state === "stored");
  }

  touches(touches: readonly Touch[]): void {
    this.change({ touches }, false);
  }

  scene(scene: string): void {
    this.change({ scene, ended: null }, true);
  }

  ended(why: string): void {
    this.change({ ended: why }, true);
  }

  hello(service: string, serviceTime: number, cutOff: CutOff | null): void {
    this.clock.arrived(serviceTime, this.now());
    if (service === this.service) return; // what was read once is not shown again at each connection
    this.service = service;
    this.change({ cutOff }, true);
  }

  history(samples: readonly Sample[]): void {
    this.series.merge(samples);
  }

  alarms(alarms: readonly Alarm[]): void {
    this.change({ alarms }, true);
  }

  /** Puts events where they belong in time. */
  events(more: readonly MissionEvent[]): void {
    const known = this.pending.events ?? this.view.events;
    const names = new Set(known.map(nameOf));
    const fresh = more.filter((event) => !names.has(nameOf(event)));
    if (fresh.length === 0) return;
    const events = [...known, ...fresh].sort((one, other) => one.time - other.time).slice(-EVENTS_KEPT);
    this.change({ events }, true);
  }

  link(link: Link): void {
    const connections = this.view.connections + (link.state === "open" ? 1 : 0);
    if (link.state === "open") this.clock.begin();
    this.change({ link, connections }, true);
  }

  /** @param asked when the service was asked, on the clock of `performance.now()`; it has answered just now. */
  health(health: Health | null, asked: number): void {
    const answerTime = this.now() - asked;
    if (health !== null) this.clock.roundTrip(asked, this.now(), health.service_time);
    const since = this.view.preparingSince;
    const preparingSince = health?.status === "preparing" ? (since ?? this.now()) : null;
    this.change({ health, preparingSince, answerTime: health === null ? null : answerTime }, true);
  }

  /** Another run. */
  reset(): void {
    this.series.clear();
    this.change({ events: [], touches: [] }, true);
  }

  /** The notice of the run that was cut off has been read. */
  readonly dismissCutOff = (): void => {
    this.change({ cutOff: null }, true);
  };

  /** Looks at the clock: what is shown may have grown old without anything happening. Called every tenth of a second. */
  readonly checkAge = (): void => {
    this.silentChecks += 1;
    // What comes all the time is published at its own pace; only what nothing tells is looked for here.
    const turned = this.judged(this.view).trust !== this.view.trust;
    if (turned || this.now() - this.publishedAt >= PUBLISH_PERIOD / 2) this.publish();
  };

  private change(change: Partial<MissionView>, atOnce: boolean): void {
    this.pending = { ...this.pending, ...change };
    if (atOnce || this.now() - this.publishedAt >= PUBLISH_PERIOD) this.publish();
  }

  private publish(): void {
    const next = this.judged({ ...this.view, ...this.pending, ...this.shared() });
    this.pending = {};
    this.publishedAt = this.now();
    if (same(next, this.view)) return;
    this.view = next;
    for (const listener of this.listeners) listener();
  }

  /** What is news, made of the objects of before wherever nothing in them has changed: panels of them are not drawn again. */
  private shared(): Partial<MissionView> {
    const { snapshot, touches } = this.pending;
    return {
      ...(snapshot && { snapshot: replaceEqualDeep(this.view.snapshot, snapshot) }),
      ...(touches && { touches: replaceEqualDeep(this.view.touches, touches) }),
    };
  }

  private judged(view: MissionView): MissionView {
    const since = view.snapshot === null ? Number.POSITIVE_INFINITY : this.clock.age(view.snapshot.service_time, this.now());
    const trust = this.trustIn(view, since);
    const age = trust === "stale" ? tenths(since) : 0;
    const robotSince = trust === "live" && view.link.state !== "stored" ? since + 1000 * (view.snapshot?.robot?.oldest ?? 0) : 0;
    const robotAge = robotSince > STALE_AFTER && view.snapshot?.robot ? tenths(robotSince) : 0;
    const wait = view.link.state === "lost" ? Math.max(0, view.link.retryAt - this.now()) : 0;
    return { ...view, trust, age, robotAge, retryIn: Math.ceil(wait / 1000) * 1000 };
  }

  private trustIn(view: MissionView, silence: number): Trust {
    if (view.link.state === "stored") return "live";
    const silent = silence > STALE_AFTER && this.silentChecks >= SILENT_CHECKS;
    if (view.link.state === "open" && view.snapshot !== null && !silent) return "live";
    if (view.health?.status === "preparing" && view.link.state !== "lost") return "preparing";
    return view.snapshot === null ? "connecting" : "stale";
  }
}

const tenths = (milliseconds: number): number => Math.floor(milliseconds / 100) * 100;

const nameOf = (event: MissionEvent): string => `${event.tick} ${event.kind} ${event.message}`;

function same(one: MissionView, other: MissionView): boolean {
  return (Object.keys(one) as (keyof MissionView)[]).every((key) => one[key] === other[key]);
}

/**
 * Where a mission is read from: live telemetry, or a stored run. A panel cannot tell which; it shows what the source
 * tells the store, and asks the source for what it can do.
 */
import type { Alarm, MissionConfiguration, MissionEvent, MissionSnapshot, Role, SceneChange, SceneView, Touch } from "../api/types";
import type { Playback } from "./playback";
import type { Sample } from "./quantities";

/** How the connection to the data is; `stored`: all there is has been read, and it does not age. */
export type Link =
  | { readonly state: "connecting" }
  | { readonly state: "open" }
  | { readonly state: "lost"; readonly attempt: number; readonly retryAt: number }
  | { readonly state: "stored" };

/** Mission time in seconds. */
export interface Range {
  readonly from: number;
  readonly to: number;
}

export interface ShownRun {
  readonly id: string;
  /** Such as "Run 20261122T113000123-4f9a2c, in progress". */
  readonly title: string;
}

export type Config = MissionConfiguration["config"];

/** A run that was under way when the service ended, which has been started again since. */
export interface CutOff {
  readonly run_id: string;
  readonly phase: string;
  /** Mission time of its last recorded tick, seconds. */
  readonly time: number;
}

/** Takes what a source tells, in the order in which it happened. */
export interface Sink {
  link(link: Link): void;
  /** The run that what follows belongs to. */
  run(run: ShownRun): void;
  /** The configuration of what is shown. */
  config(config: Config): void;
  /** A whole history: what is known of the mission up to now. */
  history(samples: readonly Sample[]): void;
  /** The mission at the moment that is shown. */
  snapshot(snapshot: MissionSnapshot): void;
  /** All touches so far. */
  touches(touches: readonly Touch[]): void;
  /** The address of the page that draws the scene at the moment that is shown. */
  scene(address: string): void;
  /** Why snapshots and scene come no more. */
  ended(why: string): void;
  /** A service, which a restart gives another name, has told the time by its own clock, in seconds, just now, and which
   * run the restart cut off. */
  hello(service: string, serviceTime: number, cutOff: CutOff | null): void;
  /** All alarms that are in the list of the live mission, the oldest first. */
  alarms(alarms: readonly Alarm[]): void;
  /** Events in any order; those that are known are not repeated. */
  events(events: readonly MissionEvent[]): void;
  /** Another mission began; nothing known so far belongs to it. */
  reset(): void;
}

/** The camera and the layers of a source's scene. */
export interface SceneArrangement {
  /** The role that changing them takes, where others see the same scene; null for none. */
  readonly changeNeeds: Role | null;
  /** @throws Refusal */
  read(): Promise<SceneView>;
  /** @throws Refusal */
  change(change: SceneChange): Promise<void>;
}

/** A picture of the scene at a moment of a stored run. */
export interface PictureRequest {
  /** By which it is known again. */
  readonly name: string;
  /** Mission time, seconds. */
  readonly time: number;
  /** Pixels. */
  readonly width: number;
  readonly height: number;
}

export interface Source {
  /** Begins to tell the sink; the returned function ends it. */
  open(sink: Sink): () => void;
  /** Milliseconds after which there may be more to `refresh`; null if there never is. */
  readonly refreshPeriod: number | null;
  /** Reads what telling has left out, or what has been added since, and tells it. @throws Refusal */
  refresh(): Promise<void>;
  /** A stretch as finely as a screen can show it, the extremes among it; null where nothing finer is known. @throws Refusal */
  readRange(range: Range): Promise<readonly Sample[] | null>;
  /** Moves the moment that is shown; null where that is always the present. */
  readonly playback: Playback | null;
  readonly scene: SceneArrangement;
  /** Has the page of the scene draw a picture and post it (features/scene/picture.ts); null where only the present is to be seen. */
  readonly takePicture: ((request: PictureRequest) => void) | null;
}

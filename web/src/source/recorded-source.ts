/** A stored run, told as a mission is; the moment that is shown is that of its playback. */
import { readEvents, readRun, readTicks } from "../api/service";
import type { Run, SceneChange, SceneView } from "../api/types";
import { Playback } from "./playback";
import { samplesOfTable, type Sample } from "./quantities";
import { POINTS, readFinely } from "./read-finely";
import { ReplaySession, type Replay, type ReplayEvents } from "./replay-session";
import { Series } from "./series";
import type { PictureRequest, Range, SceneArrangement, Sink, Source } from "./source";

/** Milliseconds between two looks at a run that is still being recorded. */
const GROWING_PERIOD = 1000;

export interface RecordedSourceOptions {
  readonly readRun: typeof readRun;
  readonly readTicks: typeof readTicks;
  readonly readEvents: typeof readEvents;
  /** Null: plots and events only, without scene and readings. */
  readonly replay: ((run: string, events: ReplayEvents) => Replay) | null;
}

const SERVICE: RecordedSourceOptions = { readRun, readTicks, readEvents, replay: (run, events) => new ReplaySession(run, events) };

export const isUnderWay = ({ status }: Pick<Run, "status">): boolean => status === "queued" || status === "running";

export class RecordedSource implements Source {
  readonly playback = new Playback();
  private readonly options: RecordedSourceOptions;
  private sink: Sink | null = null;
  private replay: Replay | null = null;
  private arrangement: SceneView | null = null;
  private growing = false;

  constructor(
    private readonly id: string,
    options: Partial<RecordedSourceOptions> = {},
  ) {
    this.options = { ...SERVICE, ...options };
  }

  open(sink: Sink): () => void {
    this.sink = sink;
    sink.link({ state: "connecting" });
    const withdraw = this.options.replay === null ? () => undefined : this.beginReplay(this.options.replay, sink);
    this.refresh().then(
      () => this.replay?.show(this.playback.read().time),
      (cause: unknown) => {
        sink.ended(cause instanceof Error ? cause.message : String(cause));
      },
    );
    return () => {
      this.sink = null;
      withdraw();
    };
  }

  get refreshPeriod(): number | null {
    return this.growing ? GROWING_PERIOD : null;
  }

  async refresh(): Promise<void> {
    const { options, id } = this;
    // First whether it still grows: what comes after the end of a run is the whole of it.
    const run = await options.readRun(id);
    const [table, events] = await Promise.all([options.readTicks(id, POINTS), options.readEvents(id)]);
    this.growing = isUnderWay(run);
    const samples = samplesOfTable(table);
    const series = new Series(samples.length);
    series.merge(samples);
    this.sink?.run({ id, title: `Run ${id}, ${run.configuration}, seed ${run.seed}` });
    this.sink?.config(run.config);
    this.sink?.history(samples);
    this.sink?.touches(run.outcome?.contacts ?? []);
    this.sink?.events(events);
    this.sink?.link({ state: "stored" });
    this.playback.extend({ end: run.duration, period: run.config.control.period, firstMotion: series.firstMotion });
  }

  async readRange(range: Range): Promise<readonly Sample[]> {
    return readFinely(this.options.readTicks, this.id, range);
  }

  readonly scene: SceneArrangement = {
    changeNeeds: null,
    read: () => (this.arrangement === null ? Promise.reject(new Error("the replay has no scene yet")) : Promise.resolve(this.arrangement)),
    change: ({ camera, layers }: SceneChange) => {
      const before = this.arrangement;
      if (before !== null) this.arrangement = { ...before, camera: camera ?? before.camera, layers: { ...before.layers, ...layers } };
      this.replay?.arrange({ ...(camera && { camera }), ...(layers && { layers }) });
      return Promise.resolve();
    },
  };

  readonly takePicture = (request: PictureRequest): void => {
    this.replay?.takePicture(request);
  };

  /** The moment of the playback is shown by the service, as long as the source is open. */
  private beginReplay(begin: NonNullable<RecordedSourceOptions["replay"]>, sink: Sink): () => void {
    const replay = begin(this.id, {
      opened: (address, view) => {
        this.arrangement = view;
        sink.scene(address);
      },
      snapshot: (snapshot) => {
        sink.snapshot(snapshot);
      },
      ended: (why) => {
        sink.ended(why);
      },
    });
    this.replay = replay;
    const withdraw = this.playback.subscribe(() => {
      replay.show(this.playback.read().time);
    });
    return () => {
      withdraw();
      replay.close();
      this.replay = null;
    };
  }
}

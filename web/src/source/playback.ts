/** The moment of a stored run that is shown: it plays, is dragged, or is stepped. */

export interface PlaybackView {
  /** Mission time, seconds. */
  readonly time: number;
  readonly playing: boolean;
  readonly speed: number;
  /** Of the last tick, seconds. */
  readonly end: number;
}

/** What is known of the run, all in seconds: mission time of the last tick, control period, and first motion. */
export interface RunTimes {
  readonly end: number;
  readonly period: number;
  readonly firstMotion: number;
}

/** Multiples of real time. */
export const SPEEDS: readonly number[] = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/** Seconds shown before the first motion. */
const LEAD = 1;

type Listener = () => void;

export class Playback {
  private view: PlaybackView = { time: 0, playing: false, speed: 1, end: 0 };
  private times: RunTimes | null = null;
  /** Where to open, if somebody said so before the run was known. */
  private opening: number | null = null;
  private readonly listeners = new Set<Listener>();

  /** Where it opens, and plays from again: nothing moves before. */
  get start(): number {
    return Math.floor(Math.max(0, this.firstMotion - LEAD) / this.period) * this.period;
  }

  get firstMotion(): number {
    return this.times?.firstMotion ?? 0;
  }

  /** Of a tick, seconds. */
  get period(): number {
    return this.times?.period ?? 0.001;
  }

  readonly subscribe = (listener: Listener): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  readonly read = (): PlaybackView => this.view;

  /** The run is known, or has become longer. At first it goes to where it was sent, else to a second before the first motion. */
  extend(times: RunTimes): void {
    const first = this.times === null;
    this.times = times;
    this.change({ end: times.end });
    if (first) this.seek(this.opening ?? this.start);
  }

  /** From the start if it stands at the end. */
  play(): void {
    const { time, end } = this.view;
    this.change({ time: time >= end - this.period / 2 ? this.start : time, playing: true });
  }

  pause(): void {
    this.change({ playing: false });
  }

  /** Before the run is known: once it is. */
  seek(time: number): void {
    if (this.times === null) this.opening = time;
    this.change({ time: this.within(time) });
  }

  /** Who shows another moment meanwhile, for a picture, shows that of the playback again. */
  showAgain(): void {
    for (const listener of this.listeners) listener();
  }

  /** By whole ticks, standing still; negative goes back. */
  step(ticks: number): void {
    const tick = Math.round(this.view.time / this.period) + ticks;
    this.change({ time: this.within(tick * this.period), playing: false });
  }

  setSpeed(speed: number): void {
    this.change({ speed });
  }

  /** So many milliseconds have passed for the person who watches. */
  advance(milliseconds: number): void {
    if (!this.view.playing) return;
    const time = this.within(this.view.time + (milliseconds / 1000) * this.view.speed);
    this.change({ time, playing: time < this.view.end });
  }

  private within(time: number): number {
    return Math.min(Math.max(0, time), this.view.end);
  }

  private change(change: Partial<PlaybackView>): void {
    const next = { ...this.view, ...change };
    if ((Object.keys(next) as (keyof PlaybackView)[]).every((key) => next[key] === this.view[key])) return;
    this.view = next;
    for (const listener of this.listeners) listener();
  }
}

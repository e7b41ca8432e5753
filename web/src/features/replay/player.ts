/** The clock of a replay: a moment of a recorded run, which plays, is dragged, or is stepped. */

export interface PlayerView {
  /** Mission time, seconds. */
  readonly time: number;
  readonly playing: boolean;
  readonly speed: number;
}

/** Multiples of real time. */
export const SPEEDS: readonly number[] = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/** Seconds shown before the first motion. */
const LEAD = 1;

type Listener = () => void;

export class Player {
  private view: PlayerView;
  private readonly listeners = new Set<Listener>();

  /**
   * Stands a second before something happens first, or at the beginning.
   * @param end mission time of the last tick; @param period of one tick; @param firstMotion when; all in seconds.
   */
  constructor(
    private end: number,
    readonly period: number,
    readonly firstMotion = 0,
  ) {
    this.view = { time: this.start, playing: false, speed: 1 };
  }

  /** Where it opens, and plays anew from: what comes before stands still. */
  get start(): number {
    return Math.floor(Math.max(0, this.firstMotion - LEAD) / this.period) * this.period;
  }

  readonly subscribe = (listener: Listener): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  readonly read = (): PlayerView => this.view;

  /** The run has become longer. */
  extend(end: number): void {
    this.end = end;
  }

  /** Begins anew if it stands at the end. */
  play(): void {
    const time = this.view.time >= this.end - this.period / 2 ? this.start : this.view.time;
    this.change({ time, playing: true });
  }

  pause(): void {
    this.change({ playing: false });
  }

  seek(time: number): void {
    this.change({ time: this.within(time) });
  }

  /** By whole ticks, standing still; negative goes back. */
  step(ticks: number): void {
    const tick = Math.round(this.view.time / this.period) + ticks;
    this.change({ time: this.within(tick * this.period), playing: false });
  }

  choose(speed: number): void {
    this.change({ speed });
  }

  /** So many milliseconds have passed for the person who watches. */
  advance(milliseconds: number): void {
    if (!this.view.playing) return;
    const time = this.within(this.view.time + (milliseconds / 1000) * this.view.speed);
    this.change({ time, playing: time < this.end });
  }

  private within(time: number): number {
    return Math.min(Math.max(0, time), this.end);
  }

  private change(change: Partial<PlayerView>): void {
    const next = { ...this.view, ...change };
    if (next.time === this.view.time && next.playing === this.view.playing && next.speed === this.view.speed) return;
    this.view = next;
    for (const listener of this.listeners) listener();
  }
}

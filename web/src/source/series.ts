/** The mission over time, in bounded memory: one typed array a quantity, for plots and the phase timeline. */
import { phaseOf, type Phase } from "./phases";
import { QUANTITY_NAMES, type QuantityName, type Sample } from "./quantities";

/** A stretch of time in one phase. */
export interface PhaseSpan {
  readonly phase: Phase;
  readonly start: number;
  readonly end: number;
}

type Listener = () => void;

type Columns = Readonly<Record<QuantityName, Float64Array>>;

const newColumns = (capacity: number): Columns =>
  Object.fromEntries(QUANTITY_NAMES.map((name) => [name, new Float64Array(capacity)])) as Record<QuantityName, Float64Array>;

/** Goes on with the phase of a later moment. */
function lengthen(spans: { phase: Phase; start: number; end: number }[], { phase: number, time }: Pick<Sample, "phase" | "time">): void {
  const phase = phaseOf(number);
  const current = spans.at(-1);
  if (current !== undefined) current.end = time;
  if (current?.phase !== phase) spans.push({ phase, start: time, end: time });
}

export class Series {
  /** Grows with every change, so that a plot knows whether it has something new to draw. */
  version = 0;
  length = 0;
  private readonly columns: Columns;
  private readonly listeners = new Set<Listener>();
  /** The phases so far; null where they have to be found out again. */
  private spans: { phase: Phase; start: number; end: number }[] | null = [];

  constructor(private readonly capacity = 16_384) {
    this.columns = newColumns(capacity);
  }

  /** Calls at every change; the returned function ends it. */
  readonly subscribe = (listener: Listener): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  clear(): void {
    this.length = 0;
    this.spans = [];
    this.changed();
  }

  /** The newest tick, -1 if there is none. */
  get lastTick(): number {
    return this.length === 0 ? -1 : this.at("tick", this.length - 1);
  }

  at(name: QuantityName, row: number): number {
    return this.columns[name][row] ?? Number.NaN;
  }

  /** Rows `from` to `to` (exclusive) of one quantity, without a copy. */
  slice(name: QuantityName, from: number, to: number): Float64Array {
    return this.columns[name].subarray(from, Math.min(to, this.length));
  }

  /** Adds a sample if it is newer than all others; a history may have told of it before it came. */
  append(sample: Sample): void {
    if (sample.tick <= this.lastTick) return;
    if (this.length === this.capacity) this.thin();
    this.write(this.length, sample);
    this.length += 1;
    if (this.spans !== null) lengthen(this.spans, sample);
    this.changed();
  }

  /** Puts the samples of a history in the place of whatever lay between its first and last tick. */
  merge(samples: readonly Sample[]): void {
    const first = samples[0];
    const last = samples.at(-1);
    if (first === undefined || last === undefined) return;
    const end = this.rowAfter(last.tick);
    const later = Array.from({ length: this.length - end }, (_, row) => this.read(end + row));
    this.length = this.rowAfter(first.tick - 0.25);
    for (const sample of [...samples, ...later]) {
      if (this.length === this.capacity) this.thin();
      this.write(this.length, sample);
      this.length += 1;
    }
    this.spans = null;
    this.changed();
  }

  /** First row at or after that time. */
  rowAt(time: number): number {
    let low = 0;
    let high = this.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.at("time", middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** When the mission first left idle, or was first recorded where that was on the way; 0 while it has not left idle. */
  get firstMotion(): number {
    const [first, second] = this.phaseSpans();
    return (first?.phase === "idle" ? second?.start : first?.start) ?? 0;
  }

  /** The phases so far, oldest first; each ends where the next begins. */
  phaseSpans(): readonly PhaseSpan[] {
    if (this.spans === null) {
      this.spans = [];
      for (let row = 0; row < this.length; row += 1) lengthen(this.spans, { phase: this.at("phase", row), time: this.at("time", row) });
    }
    return this.spans;
  }

  private changed(): void {
    this.version += 1;
    for (const listener of this.listeners) listener();
  }

  /** First row of a later tick; half ticks mark what is missing between two. */
  private rowAfter(tick: number): number {
    let row = this.length;
    while (row > 0 && this.at("tick", row - 1) > tick) row -= 1;
    return row;
  }

  private read(row: number): Sample {
    return Object.fromEntries(QUANTITY_NAMES.map((name) => [name, this.at(name, row)])) as Record<QuantityName, number>;
  }

  private write(row: number, sample: Sample): void {
    for (const name of QUANTITY_NAMES) this.columns[name][row] = sample[name];
  }

  /** Makes room: of every two neighbours in the older half the one with the greater force stays, so peaks stay true. */
  private thin(): void {
    const half = this.length >>> 1;
    let to = 0;
    for (let row = 0; row + 1 < half; row += 2) this.copy(this.force(row) >= this.force(row + 1) ? row : row + 1, to++);
    for (let row = half - (half % 2); row < this.length; row += 1) this.copy(row, to++);
    this.length = to;
  }

  private force(row: number): number {
    return Math.max(this.at("leftForce", row), this.at("rightForce", row));
  }

  private copy(from: number, to: number): void {
    for (const name of QUANTITY_NAMES) this.columns[name][to] = this.at(name, from);
  }
}

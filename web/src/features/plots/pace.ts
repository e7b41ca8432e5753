/** Plots may take this share of the browser's one thread; the scene needs the rest. */
const SHARE = 0.15;
/** Each new measurement counts this much. */
const WEIGHT = 0.2;
/** Between two drawings at least: more of them nobody sees. A millisecond less than two pictures of a screen take. */
const LEAST = 32;
/** The same where nothing moves but the time axis. */
const AT_REST = 200;
/** Between two drawings at most, however long one takes. */
const MOST = 250;

/** Decides when to draw again from how long drawing takes. Times in milliseconds. */
export class Pace {
  private cost = 0;
  private last = -Infinity;

  /** Milliseconds until the next drawing; 0 if it is due. */
  wait(now: number, atRest: boolean): number {
    return Math.max(0, this.last + Math.max(atRest ? AT_REST : LEAST, Math.min(MOST, this.cost / SHARE)) - now);
  }

  drew(at: number, cost: number): void {
    this.cost += WEIGHT * (cost - this.cost);
    this.last = at;
  }
}

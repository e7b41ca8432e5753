/** Plots may take this share of the browser's one thread; the scene needs the rest. */
const SHARE = 0.15;
/** Each new measurement counts this much. */
const WEIGHT = 0.2;

/** Decides when to draw again from how long drawing takes. Times in milliseconds. */
export class Pace {
  private cost = 0;
  private last = -Infinity;

  due(now: number): boolean {
    return now - this.last >= Math.min(250, this.cost / SHARE) - 1;
  }

  drew(at: number, cost: number): void {
    this.cost += WEIGHT * (cost - this.cost);
    this.last = at;
  }
}

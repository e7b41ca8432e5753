/**
 * The service's monotonic clock as this page sees it, so that stamps tell how old data are, whatever held them up.
 *
 * What the service stamped when it answered a request was stamped after the request was sent, and what it stamped on
 * anything was stamped before that came: two bounds on the difference of the clocks, each as good as its best instance.
 */

/** By how much two good clocks part at most, in seconds a second; bounds loosen by it as they grow old. */
const DRIFT = 2e-4;
/** Bounds this close to one another, in milliseconds, have the truth about in their middle. */
const NARROW = 250;

interface Bound {
  readonly value: number;
  readonly at: number;
}

export class ServiceClock {
  /** Of the service's clock less this page's, in milliseconds. */
  private least: Bound | null = null;
  private most: Bound | null = null;

  /** Another service may speak from now on. */
  begin(): void {
    this.least = this.most = null;
  }

  /** An answer that the service stamped, seconds, to what was asked and answered then, milliseconds. */
  roundTrip(asked: number, answered: number, serviceTime: number): void {
    const most = 1000 * serviceTime - asked;
    if (this.least !== null && most < this.leastAt(answered)) this.begin(); // one of the clocks stood still: a laptop slept
    if (this.most === null || most < this.mostAt(answered)) this.most = { value: most, at: answered };
    this.arrived(serviceTime, answered);
  }

  /** Something that the service stamped, seconds, has come, milliseconds. */
  arrived(serviceTime: number, now: number): void {
    const least = 1000 * serviceTime - now;
    if (this.most !== null && least > this.mostAt(now)) this.begin();
    if (this.least === null || least > this.leastAt(now)) this.least = { value: least, at: now };
  }

  /** How long ago the service stamped that, in milliseconds; never negative, and 0 before anything is known. */
  age(serviceTime: number, now: number): number {
    return Math.max(0, now + this.offset(now) - 1000 * serviceTime);
  }

  private offset(now: number): number {
    if (this.least === null) return Number.NEGATIVE_INFINITY;
    if (this.most === null) return this.least.value;
    // Wide apart they are while this page is slow to take what comes; what it sends still leaves at once.
    const [least, most] = [this.leastAt(now), this.mostAt(now)];
    return most - least < NARROW ? (least + most) / 2 : most;
  }

  private leastAt(now: number): number {
    return this.least === null ? Number.NEGATIVE_INFINITY : this.least.value - DRIFT * (now - this.least.at);
  }

  private mostAt(now: number): number {
    return this.most === null ? Number.POSITIVE_INFINITY : this.most.value + DRIFT * (now - this.most.at);
  }
}

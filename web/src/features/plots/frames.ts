/** When plots are drawn: once what is asked for is due, and only while they can be seen. */

/**
 * One drawing at a time, while the place that it is for can be seen.
 *
 * It is drawn when its time has come, not with a frame of the browser: to ask for one as well takes as long as a third
 * of the drawing, and a canvas shows up with the next frame anyway. A page that is hidden waits for a frame.
 */
export class Frames {
  draw: (now: number) => void = () => undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private due = Infinity;
  private request = 0;
  private seen = true;
  private missed = false;
  private ended = false;
  private readonly observer: IntersectionObserver | null;

  constructor(place: Element | null) {
    this.observer = place && new IntersectionObserver((entries) => { this.look(entries.at(-1)?.isIntersecting ?? true); });
    if (place) this.observer?.observe(place);
  }

  /** In so many milliseconds at the latest; asking costs nothing while a drawing is due sooner, and none comes after the end. */
  ask(wait: number): void {
    if (this.ended) return;
    if (!this.seen) this.missed = true;
    const due = performance.now() + wait;
    if (!this.seen || this.request !== 0 || due >= this.due) return;
    clearTimeout(this.timer);
    this.due = due;
    this.timer = setTimeout(() => {
      if (document.hidden) this.request = requestAnimationFrame((now) => { this.drawAt(now); });
      else this.drawAt(performance.now());
    }, wait);
  }

  private drawAt(now: number): void {
    this.request = 0;
    this.due = Infinity;
    this.draw(now);
  }

  /** Draw no more: what it would draw belongs to plots that are gone, and others may stand in their places. */
  end(): void {
    this.ended = true;
    clearTimeout(this.timer);
    cancelAnimationFrame(this.request);
    this.observer?.disconnect();
  }

  private look(seen: boolean): void {
    this.seen = seen;
    if (!seen || !this.missed) return;
    this.missed = false;
    this.ask(0);
  }
}

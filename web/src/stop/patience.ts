/** How long to wait for an answer, by the time in which the page could have seen it. */

const STEP = 250;

/** Aborts after so many milliseconds of a page that runs.

    `AbortSignal.timeout` also counts the seconds in which a page is held up, by the first picture of a scene or a laptop that
    sleeps: the answer is then there, and would be thrown away before anyone looks. */
export function patience(milliseconds: number): AbortSignal {
  const controller = new AbortController();
  let left = Math.ceil(milliseconds / STEP);
  const timer = setInterval(() => {
    left -= 1;
    if (left > 0) return;
    clearInterval(timer);
    controller.abort(new DOMException("no answer in time", "TimeoutError"));
  }, STEP);
  return controller.signal;
}

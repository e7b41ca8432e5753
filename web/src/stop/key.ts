/** The key that stops: Escape, wherever the focus is, also within the scene's frame. */

export const isStopKey = ({ key, repeat }: Pick<KeyboardEvent, "key" | "repeat">): boolean =>
  // A key held down is one press.
  key === "Escape" && !repeat;

/** Milliseconds between two looks for frames: one that navigates keeps its window, and forgets who listened. */
const CHECK_PERIOD = 250;

/** Listens in that window before everybody who comes later. */
function listen(target: Window, stop: () => void): void {
  target.addEventListener(
    "keydown",
    (event) => {
      if (isStopKey(event)) stop();
    },
    { capture: true },
  );
}

/** Calls `stop` at each press of the key, in this window and in all its frames. */
export function watchKey(stop: () => void): void {
  listen(window, stop);
  const heard = new WeakSet<Document>();
  const look = (): void => {
    for (const frame of document.querySelectorAll("iframe")) {
      // A frame that could not be loaded shows a page of the browser's own, which lets nobody look.
      const { contentDocument, contentWindow } = frame;
      if (contentDocument === null || contentWindow === null || heard.has(contentDocument)) continue;
      heard.add(contentDocument);
      listen(contentWindow, stop);
    }
  };
  setInterval(look, CHECK_PERIOD);
  // A frame was loaded, or takes the focus.
  document.addEventListener("load", look, { capture: true });
  window.addEventListener("blur", look);
}

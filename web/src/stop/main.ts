/**
 * STOP: a script of its own within `index.html`, there before the console is loaded and whatever becomes of it.
 * It knows the document and `fetch`, nothing of the rest; docs/decisions/0007 says why.
 */
import { PHASE_KNOWN, STOP_PRESSED } from "./events";
import { watchKey } from "./key";
import { watchLoading } from "./loading";
import { StopNote } from "./note";
import { keepInView } from "./place";
import { sendStop } from "./send";
import "./stop.css";

// Looked for when needed: this runs before the page's body is read.
const note = new StopNote(() => document.getElementById("stop-note"));

/** The latest press; an answer to an earlier one says nothing about it, unless it is a confirmation. */
let latest = 0;

function stop(): void {
  latest += 1;
  const press = latest;
  const answer = sendStop();
  note.stopping();
  window.dispatchEvent(new Event(STOP_PRESSED));
  void answer.then((verdict) => {
    if (press === latest || verdict.kind === "stopped") note.answered(verdict);
  });
}

// At the window and before everybody else, so that nothing on the page can keep a press from it.
window.addEventListener(
  "click",
  (event) => {
    if (!(event.target instanceof Element) || event.target.closest("#stop-button") === null) return;
    event.preventDefault();
    stop();
  },
  { capture: true },
);
window.addEventListener(PHASE_KNOWN, (event) => {
  const phase: unknown = event instanceof CustomEvent ? event.detail : null;
  note.known(typeof phase === "string" ? phase : null);
});
watchKey(stop);
keepInView(() => document.getElementById("stop"));
watchLoading();

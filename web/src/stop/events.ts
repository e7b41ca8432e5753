/**
 * What STOP and the rest of the page tell each other: events of the window, so that neither needs the other.
 * STOP listens to nothing else, and stops just as well if nobody listens to it.
 */

/** STOP was pressed. */
export const STOP_PRESSED = "becalm:stop-pressed";

/** The phase of the mission as far as fresh data tell, or null; in the event's `detail`. */
export const PHASE_KNOWN = "becalm:phase-known";

export function announcePhase(phase: string | null): void {
  window.dispatchEvent(new CustomEvent(PHASE_KNOWN, { detail: phase }));
}

export function onStopPressed(listener: () => void): () => void {
  window.addEventListener(STOP_PRESSED, listener);
  return () => {
    window.removeEventListener(STOP_PRESSED, listener);
  };
}

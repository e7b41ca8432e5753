/** The key that stops: Escape, wherever the focus is, also within the scene's frame. */
import { useEffect } from "react";
import type { CommandDesk } from "./desk";
import { useDesk } from "./context";

export const STOP_KEY = "Escape";
export const STOP_KEY_LABEL = "Esc";

function listen(target: Window, desk: CommandDesk): () => void {
  const pressed = (event: KeyboardEvent): void => {
    // A key held down is one press.
    if (event.key === STOP_KEY && !event.repeat) void desk.stop();
  };
  try {
    target.addEventListener("keydown", pressed, { capture: true });
  } catch {
    // A frame that could not be loaded shows a page of the browser's own, which lets nobody listen.
    return () => undefined;
  }
  return () => {
    target.removeEventListener("keydown", pressed, { capture: true });
  };
}

/** Listens in that window; the object around it changes when its document does. */
export function useStopKey(place: { readonly window: Window | null } | null): void {
  const desk = useDesk();
  useEffect(() => (place?.window ? listen(place.window, desk) : undefined), [place, desk]);
}

/** What disarms beside the desk itself: the service, and the key that stops. */
import { useEffect } from "react";
import { useStore } from "../../store/context";
import type { CommandDesk } from "./desk";
import { STOP_KEY } from "./stop-key";

export function useDisarming(desk: CommandDesk): void {
  const store = useStore();
  useEffect(
    () =>
      store.subscribe(() => {
        const { snapshot } = store.read();
        if (snapshot !== null) desk.heed(snapshot.armed);
      }),
    [store, desk],
  );
  useEffect(() => {
    const pressed = (event: KeyboardEvent): void => {
      if (event.key === STOP_KEY) desk.disarm();
    };
    window.addEventListener("keydown", pressed, { capture: true });
    return () => {
      window.removeEventListener("keydown", pressed, { capture: true });
    };
  }, [desk]);
}

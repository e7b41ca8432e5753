/** What disarms beside the desk itself: the service, and STOP. */
import { useEffect } from "react";
import { useStore } from "../../store/context";
import { onStopPressed } from "../../stop/events";
import type { CommandDesk } from "./desk";

export function useDisarming(desk: CommandDesk): void {
  const store = useStore();
  useEffect(
    () =>
      store.subscribe(() => {
        const { snapshot } = store.read();
        if (snapshot !== null) desk.followService(snapshot.armed);
      }),
    [store, desk],
  );
  useEffect(() => onStopPressed(() => { desk.disarm(); }), [desk]);
}

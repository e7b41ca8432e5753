/** How panels reach the store. */
import { createContext, useContext, useSyncExternalStore } from "react";
import type { MissionSnapshot } from "../api/types";
import type { MissionStore, MissionView } from "./mission";

export const StoreContext = createContext<MissionStore | null>(null);

export function useStore(): MissionStore {
  const store = useContext(StoreContext);
  if (store === null) throw new Error("a panel stands outside of the mission's store");
  return store;
}

/** A part of the view; the panel is drawn again only when that part changes, so select values or unchanged objects. */
export function useView<Part>(select: (view: MissionView) => Part): Part {
  const store = useStore();
  return useSyncExternalStore(store.subscribe, () => select(store.read()));
}

/** A part of the latest snapshot; null before the first one. */
export function useSnapshot<Part>(select: (snapshot: MissionSnapshot) => Part): Part | null {
  return useView((view) => (view.snapshot === null ? null : select(view.snapshot)));
}

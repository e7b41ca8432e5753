/** How panels reach the store. */
import { createContext, useContext, useSyncExternalStore } from "react";
import type { MissionSnapshot } from "../api/types";
import type { MissionStore, MissionView, Trust } from "./mission";

export const StoreContext = createContext<MissionStore | null>(null);

export function useStore(): MissionStore {
  const store = useContext(StoreContext);
  if (store === null) throw new Error("a panel stands outside of the mission's store");
  return store;
}

const never = (): (() => void) => () => undefined;

/** A part of the view of that store, or of none; drawn again only when that part changes, so select values or unchanged objects. */
export function useViewOf<Part>(store: MissionStore | null, select: (view: MissionView) => Part): Part | null {
  return useSyncExternalStore(store?.subscribe ?? never, () => (store === null ? null : select(store.read())));
}

/** A part of the view of what the panel shows; likewise. */
export function useView<Part>(select: (view: MissionView) => Part): Part {
  const store = useStore();
  return useSyncExternalStore(store.subscribe, () => select(store.read()));
}

/** A part of the snapshot; null before the first one. */
export function useSnapshot<Part>(select: (snapshot: MissionSnapshot) => Part): Part | null {
  return useView((view) => (view.snapshot === null ? null : select(view.snapshot)));
}

/** How the data of what is shown are, for the element around it: panels within grey by it (ui/theme/global.css). */
export function useDataState(): { readonly "data-trust": Trust; readonly "data-robot": "silent" | undefined } {
  const trust = useView((view) => view.trust);
  const silent = useView((view) => view.robotAge > 0);
  return { "data-trust": trust, "data-robot": silent ? "silent" : undefined };
}

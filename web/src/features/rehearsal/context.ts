import { createContext, useContext, useSyncExternalStore } from "react";
import type { MissionSnapshot } from "../../api/types";
import { RehearsalDesk, type RehearsalView } from "./desk";

export const RehearsalContext = createContext(new RehearsalDesk());

export const useRehearsalDesk = (): RehearsalDesk => useContext(RehearsalContext);

export function useRehearsal<Part>(select: (view: RehearsalView) => Part): Part {
  const desk = useRehearsalDesk();
  return useSyncExternalStore(desk.subscribe, () => select(desk.read()));
}

/** A moment of a stored run, for futures to begin in. */
export interface StoredMoment {
  readonly run: string;
  /** Mission time, seconds. */
  readonly at: number;
  readonly phase: MissionSnapshot["phase"] | null;
}

/** Null where futures begin in the live mission's state as it is. */
export const MomentContext = createContext<StoredMoment | null>(null);

export const useStoredMoment = (): StoredMoment | null => useContext(MomentContext);

import { createContext, useContext, useSyncExternalStore } from "react";
import { RehearsalDesk, type RehearsalView } from "./desk";

export const RehearsalContext = createContext(new RehearsalDesk());

export const useRehearsalDesk = (): RehearsalDesk => useContext(RehearsalContext);

export function useRehearsal<Part>(select: (view: RehearsalView) => Part): Part {
  const desk = useRehearsalDesk();
  return useSyncExternalStore(desk.subscribe, () => select(desk.read()));
}

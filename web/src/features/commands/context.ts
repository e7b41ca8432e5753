import { createContext, useContext, useSyncExternalStore } from "react";
import { CommandDesk, type DeskView } from "./desk";

export const DeskContext = createContext(new CommandDesk());

export const useDesk = (): CommandDesk => useContext(DeskContext);

export function useDeskView<Part>(select: (view: DeskView) => Part): Part {
  const desk = useDesk();
  return useSyncExternalStore(desk.subscribe, () => select(desk.read()));
}

/** The units that a person prefers; kept in this browser, never sent. */
import { createContext, useContext, useMemo } from "react";
import { useKept } from "../ui/use-kept";
import type { AngleUnit } from "./units";

export interface Preferences {
  readonly angles: AngleUnit;
  readonly setAngles: (angles: AngleUnit) => void;
}

export const PreferencesContext = createContext<Preferences>({ angles: "rad", setAngles: () => undefined });

export const usePreferences = (): Preferences => useContext(PreferencesContext);

export function usePreferencesState(): Preferences {
  const [angles, setAngles] = useKept<AngleUnit>("becalm-angles", "rad", ["rad", "deg"]);
  // `setAngles` only closes over the key.
  // eslint-disable-next-line react-hooks/exhaustive-deps
  return useMemo(() => ({ angles, setAngles }), [angles]);
}

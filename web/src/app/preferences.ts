/** What a person prefers to see; kept in this browser, never sent. */
import { createContext, useContext, useMemo, useState } from "react";
import type { AngleUnit } from "../units/units";

export interface Preferences {
  readonly angles: AngleUnit;
  readonly setAngles: (angles: AngleUnit) => void;
}

export const PreferencesContext = createContext<Preferences>({ angles: "rad", setAngles: () => undefined });

export const usePreferences = (): Preferences => useContext(PreferencesContext);

/** A word kept under that key; a browser that keeps nothing just forgets it. */
export function useKept<Word extends string>(key: string, initial: Word, allowed: readonly Word[]): [Word, (word: Word) => void] {
  const [word, setWord] = useState<Word>(() => {
    try {
      const kept = localStorage.getItem(key);
      return allowed.find((known) => known === kept) ?? initial;
    } catch {
      return initial;
    }
  });
  const keep = (next: Word): void => {
    setWord(next);
    try {
      localStorage.setItem(key, next);
    } catch {
      // Private windows may refuse; the choice then lasts until the page is closed.
    }
  };
  return [word, keep];
}

export function usePreferencesState(): Preferences {
  const [angles, setAngles] = useKept<AngleUnit>("becalm-angles", "rad", ["rad", "deg"]);
  // `setAngles` only closes over the key.
  // eslint-disable-next-line react-hooks/exhaustive-deps
  return useMemo(() => ({ angles, setAngles }), [angles]);
}

/** A choice that this browser keeps; it is never sent. */
import { useState } from "react";

/** The word kept under that key; a browser that keeps nothing just forgets it. */
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

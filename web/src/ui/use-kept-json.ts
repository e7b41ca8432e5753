/** Something with more parts than a word that this browser keeps, or this tab until it is closed; it is never sent. */
import { useState } from "react";

/** What is kept under that key, as `read` understands it; a browser that keeps nothing just forgets it. */
/** `tab`: a draft, which another tab does not share. */
export type KeptIn = "browser" | "tab";

const placeOf = (kept: KeptIn): Storage => (kept === "tab" ? sessionStorage : localStorage);

export function readKept<Value>(key: string, read: (kept: unknown) => Value, kept: KeptIn = "browser"): Value {
  try {
    return read(JSON.parse(placeOf(kept).getItem(key) ?? "null"));
  } catch {
    return read(null);
  }
}

export function keep(key: string, value: unknown, kept: KeptIn = "browser"): void {
  try {
    placeOf(kept).setItem(key, JSON.stringify(value));
  } catch {
    // Private windows may refuse, and what is too much is not kept; it then lasts until the page is closed.
  }
}

/** @param read understands whatever is kept, null where nothing is; earlier versions, and people, may have written it. */
export function useKeptJson<Value>(key: string, read: (kept: unknown) => Value, kept: KeptIn = "browser"): [Value, (value: Value) => void] {
  const [value, setValue] = useState<Value>(() => readKept(key, read, kept));
  return [
    value,
    (next) => {
      setValue(next);
      keep(key, next, kept);
    },
  ];
}

/** A choice that this browser keeps, seen by several parts of the page and by its other tabs at once. */
import { useSyncExternalStore } from "react";

export interface SharedChoice<Word extends string> {
  readonly key: string;
  readonly initial: Word;
  readonly allowed: readonly Word[];
}

const CHANGED = "becalm:choice";
/** Of a browser that keeps nothing: until the page is closed. */
const unkept = new Map<string, string>();

function read<Word extends string>({ key, initial, allowed }: SharedChoice<Word>): Word {
  let kept: string | null = unkept.get(key) ?? null;
  try {
    kept ??= localStorage.getItem(key);
  } catch {
    // Private windows may refuse.
  }
  return allowed.find((known) => known === kept) ?? initial;
}

function subscribe(listener: () => void): () => void {
  window.addEventListener(CHANGED, listener);
  window.addEventListener("storage", listener);
  return () => {
    window.removeEventListener(CHANGED, listener);
    window.removeEventListener("storage", listener);
  };
}

/** Keeps a text, and tells everyone on the page. */
export function keepShared(key: string, text: string): void {
  try {
    localStorage.setItem(key, text);
  } catch {
    unkept.set(key, text);
  }
  window.dispatchEvent(new Event(CHANGED));
}

export function useShared<Word extends string>(choice: SharedChoice<Word>): [Word, (word: Word) => void] {
  const word = useSyncExternalStore(subscribe, () => read(choice));
  return [
    word,
    (next) => {
      keepShared(choice.key, next);
    },
  ];
}

/** The text that is kept, as its value was read once: whoever asks again is given the same object. */
const readOnce = new Map<string, { readonly text: string | null; readonly value: unknown }>();

function valueOf<Value>(key: string, understand: (kept: unknown) => Value): Value {
  let text: string | null = unkept.get(key) ?? null;
  try {
    text ??= localStorage.getItem(key);
  } catch {
    // Private windows may refuse.
  }
  const known = readOnce.get(key);
  if (known?.text === text) return known.value as Value;
  let kept: unknown = null;
  try {
    kept = JSON.parse(text ?? "null");
  } catch {
    // Not written by this page.
  }
  const value = understand(kept);
  readOnce.set(key, { text, value });
  return value;
}

/** Likewise for what has more parts than a word. @param understand whatever is kept, null where nothing is. */
export function useSharedJson<Value>(key: string, understand: (kept: unknown) => Value): [Value, (value: Value) => void] {
  const value = useSyncExternalStore(subscribe, () => valueOf(key, understand));
  return [
    value,
    (next) => {
      keepShared(key, JSON.stringify(next));
    },
  ];
}

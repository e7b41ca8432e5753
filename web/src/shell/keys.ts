/** What a key means for the whole page: nothing while somebody types. */
import type { Page } from "../store/route";

export type Meaning = "palette" | "sheet" | "chord" | { readonly page: Page } | null;

const PAGE_KEYS: Readonly<Record<string, Page>> = { m: "mission", r: "runs", s: "studies", a: "atlas", w: "alarms", l: "link" };

interface Key {
  readonly key: string;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly altKey: boolean;
  readonly target: EventTarget | null;
}

/** Where a letter is text. */
const isTyping = (target: EventTarget | null): boolean => {
  const element = target as { readonly tagName?: string; readonly isContentEditable?: boolean } | null;
  return ["INPUT", "TEXTAREA", "SELECT"].includes(element?.tagName ?? "") || element?.isContentEditable === true;
};

/** @param begun whether "g" was pressed just before. */
export function keyMeaning({ key, ctrlKey, metaKey, altKey, target }: Key, begun: boolean): Meaning {
  if ((ctrlKey || metaKey) && !altKey && key.toLowerCase() === "k") return "palette";
  if (ctrlKey || metaKey || altKey || isTyping(target)) return null;
  if (begun) {
    const page = PAGE_KEYS[key];
    if (page !== undefined) return { page };
  }
  if (key === "?") return "sheet";
  return key === "g" ? "chord" : null;
}

/** Which page is shown: the part of the address behind `#`, so that it works under any path and a page can be kept. */
import { useSyncExternalStore } from "react";

export const PAGES = ["mission", "runs", "studies", "atlas", "alarms", "link"] as const;
export type Page = (typeof PAGES)[number];

export interface Route {
  readonly page: Page;
  /** What the page shows of its kind: the identifier of a run or study; empty for none. */
  readonly item: string;
  /** What it is compared with; empty for nothing. */
  readonly other: string;
}

/** What an address names; as it stands where it was typed badly, such as `%` alone: nothing of that name will be found. */
function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

/** `#/studies/20261125T103000123-4f9a2c`, `#/runs/ONE/OTHER` and the like; what follows a `?` is the page's own; anything unknown is the mission. */
export function routeOf(hash: string): Route {
  const [name = "", item = "", other = ""] = hash.replace(/^#\/?/, "").replace(/\?.*$/, "").split("/");
  const page = PAGES.find((known) => known === name) ?? "mission";
  return { page, item: decoded(item), other: decoded(other) };
}

export const hashOf = ({ page, item, other }: Pick<Route, "page" | "item"> & Partial<Route>): string =>
  `#/${[page, item, other ?? ""].filter(Boolean).map(encodeURIComponent).join("/")}`;

export function go(page: Page, item = ""): void {
  location.hash = hashOf({ page, item });
}

/** Calls whenever the address changes; the returned function ends it. */
export function subscribe(listener: () => void): () => void {
  window.addEventListener("hashchange", listener);
  return () => {
    window.removeEventListener("hashchange", listener);
  };
}

/** The part of the address behind `#`, with it. */
export const useHash = (): string => useSyncExternalStore(subscribe, () => location.hash);

export function useRoute(): Route {
  return routeOf(useHash());
}

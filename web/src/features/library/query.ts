/** What the library is asked for, as the address keeps it: `#/runs?text=damping&sort=-peak_tip_force&page=3`. */
import { useSyncExternalStore } from "react";
import { hashOf } from "../../store/route";
import type { RunsQuery } from "../../api/types";

export const PAGE_SIZE = 50;

export const STATUSES = ["queued", "running", "finished", "failed", "cancelled"] as const;
export const KINDS = ["live", "scripted", "study", "fork", "imported"] as const;
export const VERDICTS = [
  "caged_force_reduced",
  "caged_force_not_reduced",
  "caged_unplanned_contact",
  "ejection",
  "base_collision",
  "unresolved",
] as const;

export const SORT_KEYS = [
  "started",
  "name",
  "kind",
  "configuration",
  "changes",
  "seed",
  "initial_spin",
  "duration",
  "outcome",
  "at_first_closure",
  "peak_tip_force",
  "cage_margin",
] as const;
export type SortKey = (typeof SORT_KEYS)[number];

export interface LibraryQuery {
  readonly text: string;
  readonly kind: (typeof KINDS)[number] | "";
  readonly status: (typeof STATUSES)[number] | "";
  readonly outcome: (typeof VERDICTS)[number] | "";
  /** The paper's verdict. */
  readonly at_first_closure: (typeof VERDICTS)[number] | "";
  readonly tag: string;
  readonly starred: boolean;
  readonly sort: SortKey;
  readonly descending: boolean;
  /** From 1. */
  readonly page: number;
}

export const DEFAULT_QUERY: LibraryQuery = {
  text: "",
  kind: "",
  status: "",
  outcome: "",
  at_first_closure: "",
  tag: "",
  starred: false,
  sort: "started",
  descending: true,
  page: 1,
};

const oneOf = <Word extends string>(words: readonly Word[], asked: string | null): Word | "" => words.find((word) => word === asked) ?? "";

/** What the part of an address after its question mark asks for; what cannot be is left out. */
export function queryOf(address: string): LibraryQuery {
  const asked = new URLSearchParams(address);
  const sort = asked.get("sort") ?? "-started";
  const page = Number(asked.get("page") ?? 1);
  return {
    text: asked.get("text") ?? "",
    kind: oneOf(KINDS, asked.get("kind")),
    status: oneOf(STATUSES, asked.get("status")),
    outcome: oneOf(VERDICTS, asked.get("outcome")),
    at_first_closure: oneOf(VERDICTS, asked.get("at_first_closure")),
    tag: asked.get("tag") ?? "",
    starred: asked.get("starred") === "true",
    sort: oneOf(SORT_KEYS, sort.replace(/^-/, "")) || "started",
    descending: sort.startsWith("-"),
    page: Number.isInteger(page) && page >= 1 ? page : 1,
  };
}

const sortOf = ({ sort, descending }: LibraryQuery): string => (descending ? "-" : "") + sort;

/** The shortest address that asks for this; empty for everything, newest first. */
export function addressOfQuery(query: LibraryQuery): string {
  const parts = new URLSearchParams();
  for (const name of ["text", "kind", "status", "outcome", "at_first_closure", "tag"] as const) {
    if (query[name] !== "") parts.set(name, query[name]);
  }
  if (query.starred) parts.set("starred", "true");
  if (sortOf(query) !== "-started") parts.set("sort", sortOf(query));
  if (query.page > 1) parts.set("page", String(query.page));
  return parts.toString();
}

/** The same for the service. */
export function requestOf(query: LibraryQuery): RunsQuery {
  const { text, kind, status, outcome, at_first_closure: paper, tag, starred, page } = query;
  return {
    ...(text.trim() !== "" && { text: text.trim().slice(0, 400) }),
    ...(kind !== "" && { kind }),
    ...(status !== "" && { status }),
    ...(outcome !== "" && { outcome }),
    ...(paper !== "" && { at_first_closure: paper }),
    ...(tag !== "" && { tag: tag.slice(0, 40) }),
    ...(starred && { starred }),
    sort: sortOf(query),
    limit: PAGE_SIZE,
    offset: (page - 1) * PAGE_SIZE,
  };
}

/** Whether anything but the order and the page is asked for. */
export const isFiltered = (query: LibraryQuery): boolean =>
  addressOfQuery({ ...query, sort: "started", descending: true, page: 1 }) !== "";

/** Ordered by that key: the other way round if it is already; figures and times begin with the largest. */
export function sortedBy(query: LibraryQuery, sort: SortKey): LibraryQuery {
  const words = ["name", "kind", "configuration", "outcome", "at_first_closure", "changes"].includes(sort);
  const descending = query.sort === sort ? !query.descending : !words;
  return { ...query, sort, descending, page: 1 };
}

/** The address of a run, or of none, that keeps what is asked for. */
export function runHash(query: LibraryQuery, item = "", other = ""): string {
  const asked = addressOfQuery(query);
  return hashOf({ page: "runs", item, other }) + (asked === "" ? "" : `?${asked}`);
}

/** Asks for something else, without a step in the browser's history. */
export function showQuery(query: LibraryQuery, item = "", other = ""): void {
  location.replace(runHash(query, item, other));
}

const addressNow = (): string => (location.hash.startsWith("#/runs") ? (location.hash.split("?")[1] ?? "") : "");

function subscribe(listener: () => void): () => void {
  window.addEventListener("hashchange", listener);
  return () => {
    window.removeEventListener("hashchange", listener);
  };
}

/** What the address asks for now. */
export const useQueryAddress = (): string => useSyncExternalStore(subscribe, addressNow);

/** Filters that a person keeps by name, in this browser. */
import { addressOfQuery, queryOf, type LibraryQuery } from "./query";

export interface SavedFilter {
  readonly name: string;
  /** As in the address, without its page. */
  readonly address: string;
}

const MOST = 50;

const isSaved = (value: unknown): value is SavedFilter =>
  typeof value === "object" && value !== null && "name" in value && typeof value.name === "string" && "address" in value && typeof value.address === "string";

/** What was kept; what is none of it is left out, and so is whatever a query does not know. */
export const readSaved = (kept: unknown): readonly SavedFilter[] =>
  Array.isArray(kept) ? kept.filter(isSaved).slice(0, MOST).map(({ name, address }) => ({ name, address: addressOfQuery(queryOf(address)) })) : [];

/** With that one, in place of another of its name. */
export function withFilter(saved: readonly SavedFilter[], name: string, query: LibraryQuery): readonly SavedFilter[] {
  const kept = { name: name.trim(), address: addressOfQuery({ ...query, page: 1 }) };
  return [...saved.filter((each) => each.name !== kept.name), kept].sort((one, other) => one.name.localeCompare(other.name)).slice(0, MOST);
}

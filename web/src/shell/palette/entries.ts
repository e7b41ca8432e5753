/** What can be found in the command palette, and which of it a text finds. */

export interface Entry {
  readonly id: string;
  readonly group: string;
  readonly label: string;
  /** Beside the label, such as a meaning or a path. */
  readonly hint: string;
  /** What finds it beside label and hint. */
  readonly words?: string;
  readonly run: () => void;
}

/** So many are shown. */
export const MOST_SHOWN = 60;

const plain = (text: string): string => text.toLowerCase().replaceAll("_", " ");

/** How well a text finds it: the beginning of its label before a word of it, before anything else; null if it does not. */
function rankOf({ label, hint, words = "" }: Entry, sought: string): number | null {
  const parts = sought.split(" ").filter(Boolean);
  const name = plain(label);
  const all = `${name} ${plain(hint)} ${plain(words)}`;
  if (!parts.every((part) => all.includes(part))) return null;
  if (name.startsWith(sought)) return 0;
  if (` ${name}`.includes(` ${sought}`)) return 1;
  return parts.every((part) => name.includes(part)) ? 2 : 3;
}

/** The best first; of equals as they stand. Without a text, those of the groups that are shown unasked. */
export function found(entries: readonly Entry[], text: string, unasked: ReadonlySet<string>): Entry[] {
  const sought = plain(text).trim().replace(/\s+/g, " ");
  if (sought === "") return entries.filter(({ group }) => unasked.has(group)).slice(0, MOST_SHOWN);
  return entries
    .map((entry) => ({ entry, rank: rankOf(entry, sought) }))
    .filter(({ rank }) => rank !== null)
    .sort((one, other) => (one.rank ?? 0) - (other.rank ?? 0))
    .slice(0, MOST_SHOWN)
    .map(({ entry }) => entry);
}

/** The place that an arrow key goes to, round the ends. */
export function stepped(place: number, key: string, count: number): number {
  if (count === 0) return 0;
  if (key === "ArrowDown") return (place + 1) % count;
  if (key === "ArrowUp") return (place - 1 + count) % count;
  return place;
}

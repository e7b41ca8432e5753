/** How each measure lies over each varied parameter alone, whatever the others are: classes as shares, numbers as quantiles. */
import type { StudyRow } from "../../api/types";
import type { Axis } from "./layout";

/** Values, or stretches of values, that a parameter is taken apart into, at most. */
export const MOST_GROUPS = 12;

/** Cells whose parameter has one value, or lies in one stretch. */
export interface Group {
  /** As it stands below. */
  readonly words: string;
  readonly rows: readonly StudyRow[];
}

/** Of a column in a group. */
export type Spread =
  | { readonly kind: "classes"; readonly shares: ReadonlyMap<string, number>; readonly count: number }
  | { readonly kind: "numbers"; readonly low: number; readonly quarter: number; readonly median: number; readonly threeQuarters: number; readonly high: number; readonly count: number }
  | { readonly kind: "none" };

const short = (value: number): string => String(Number(value.toPrecision(3)));

/** A parameter's cells by its values; of more than `MOST_GROUPS`, and of drawn ones, by stretches with as many cells each. */
export function groupsOf(axis: Axis, rows: Iterable<StudyRow>): readonly Group[] {
  const all = [...rows];
  if (axis.values !== null && axis.values.length <= MOST_GROUPS) {
    return axis.values.map((value) => ({ words: typeof value === "number" ? short(value) : value, rows: all.filter((row) => row[axis.path] === value) }));
  }
  const placed = all.flatMap((row) => {
    const at = row[axis.path];
    return typeof at === "number" ? [{ at, row }] : [];
  });
  placed.sort((one, other) => one.at - other.at);
  const count = Math.min(MOST_GROUPS, Math.max(1, Math.floor(placed.length / 4)));
  return Array.from({ length: count }, (_, place) => {
    const part = placed.slice(Math.floor((place * placed.length) / count), Math.floor(((place + 1) * placed.length) / count));
    return { words: short(part[part.length >> 1]?.at ?? Number.NaN), rows: part.map(({ row }) => row) };
  });
}

/** By linear interpolation between the order statistics. */
export function quantile(sorted: readonly number[], share: number): number {
  const place = (sorted.length - 1) * share;
  const [below, above] = [sorted[Math.floor(place)] ?? Number.NaN, sorted[Math.ceil(place)] ?? Number.NaN];
  return below + (above - below) * (place - Math.floor(place));
}

/** How a column lies in a group. */
export function spreadOf(rows: readonly StudyRow[], column: string): Spread {
  const values = rows.map((row) => row[column] ?? null).filter((value) => value !== null);
  const numbers = values.filter((value) => typeof value === "number").sort((one, other) => one - other);
  if (numbers.length > 0) {
    const [low, quarter, median, threeQuarters, high] = [0.05, 0.25, 0.5, 0.75, 0.95].map((share) => quantile(numbers, share)) as [number, number, number, number, number];
    return { kind: "numbers", low, quarter, median, threeQuarters, high, count: numbers.length };
  }
  const names = values.map(String);
  if (names.length === 0) return { kind: "none" };
  const shares = new Map<string, number>();
  for (const name of names) shares.set(name, (shares.get(name) ?? 0) + 1 / names.length);
  return { kind: "classes", shares, count: names.length };
}

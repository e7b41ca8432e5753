/** Where the cells of a study stand on a map: two axes of its grid across, a third from panel to panel. */
import type { StudyDetail, StudyRow } from "../../api/types";

export type Axis = StudyDetail["axes"][number];
/** What a map has to know of what is drawn: a study, or whatever else has cells over two axes. */
export type Mapped = Pick<StudyDetail, "name" | "axes" | "columns" | "progress">;

export type Value = NonNullable<Axis["values"]>[number];

/** A grid axis: one that has its values listed. */
export interface GridAxis extends Axis {
  readonly values: Value[];
}

export interface Spread {
  readonly x: GridAxis;
  /** Null where the grid has a single axis. */
  readonly y: GridAxis | null;
  /** One panel for each of its values; null for one panel alone. */
  readonly facet: GridAxis | null;
}

/** The cells at one place of a panel: one, or as many as the sample has points. */
export interface Place {
  readonly column: number;
  readonly row: number;
  readonly cells: readonly number[];
}

export interface Panel {
  /** Null where there is one panel alone. */
  readonly facet: Value | null;
  readonly places: readonly Place[];
}

export const gridAxes = (study: Mapped): GridAxis[] =>
  study.axes.filter((axis): axis is GridAxis => axis.values !== null);

/** The last two axes of the grid across, as the paper draws its tables; the first of what is left from panel to panel. */
export function usualSpread(study: Mapped): Spread | null {
  const axes = gridAxes(study);
  const x = axes.at(-2) ?? axes.at(-1);
  if (x === undefined) return null;
  const y = axes.length > 1 ? (axes.at(-1) ?? null) : null;
  return { x, y, facet: axes.length > 2 ? (axes[0] ?? null) : null };
}

/** How many draws stand at each place of the grid. */
export function pointsOf(study: Mapped): number {
  const places = gridAxes(study).reduce((count, axis) => count * axis.values.length, 1);
  return Math.max(1, Math.round(study.progress.total / places));
}

/** The cells at these places of the grid's axes, in the service's order: the last axis fastest, draws fastest of all. */
export function cellsAt(study: Mapped, chosen: ReadonlyMap<string, number>): number[] {
  const place = gridAxes(study).reduce((sum, axis) => sum * axis.values.length + (chosen.get(axis.path) ?? 0), 0);
  const points = pointsOf(study);
  return Array.from({ length: points }, (_, point) => place * points + point);
}

/** The panels of a map; axes that are not spread stay at their chosen place, the first if none is chosen. */
export function panelsOf(study: Mapped, spread: Spread, chosen: ReadonlyMap<string, number>): Panel[] {
  const facets = spread.facet?.values ?? [null];
  return facets.map((facet, number) => ({
    facet,
    places: spread.x.values.flatMap((_, column) =>
      (spread.y?.values ?? [null]).map((__, row) => {
        const at = new Map(chosen).set(spread.x.path, column);
        if (spread.y !== null) at.set(spread.y.path, row);
        if (spread.facet !== null) at.set(spread.facet.path, number);
        return { column, row, cells: cellsAt(study, at) };
      }),
    ),
  }));
}

/** What a place shows: of classes the most frequent with its share, of numbers the mean; `none` where what was run has none. */
export type Shown =
  | { readonly kind: "class"; readonly name: string; readonly share: number }
  | { readonly kind: "number"; readonly value: number }
  | { readonly kind: "failed" }
  | { readonly kind: "none" }
  | { readonly kind: "empty" };

const mean = (values: readonly number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;

function mostFrequent(names: readonly string[]): Shown {
  const counts = new Map<string, number>();
  for (const name of names) counts.set(name, (counts.get(name) ?? 0) + 1);
  const [name, count] = [...counts].reduce((best, each) => (each[1] > best[1] ? each : best));
  return { kind: "class", name, share: count / names.length };
}

export function shownAt(rows: readonly StudyRow[], column: string): Shown {
  if (rows.length === 0) return { kind: "empty" };
  const values = rows.map((row) => row[column] ?? null).filter((value) => value !== null);
  const names = values.filter((value) => typeof value === "string");
  if (names.length > 0) return mostFrequent(names);
  const flags = values.filter((value) => typeof value === "boolean");
  if (flags.length > 0) return mostFrequent(flags.map(String));
  const numbers = values.filter((value) => typeof value === "number");
  if (numbers.length > 0) return { kind: "number", value: mean(numbers) };
  return { kind: rows.some((row) => row["error"] !== null) ? "failed" : "none" };
}

/** The least and the largest number of a column; null if there is none. */
export function rangeOf(rows: Iterable<StudyRow>, column: string): readonly [number, number] | null {
  let [low, high] = [Infinity, -Infinity];
  for (const row of rows) {
    const value = row[column];
    if (typeof value !== "number") continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? [low, high] : null;
}

/** A second recording on the clock of the first: both begin to move at the same place of the axis. */
import { createContext, useContext } from "react";
import type { QuantityName } from "../../source/quantities";
import type { Series } from "../../source/series";
import type { Range } from "../../source/source";
import type { MissionStore } from "../../store/mission";

/** Where the two lie over one another: at their first motions, or by mission time. */
export type Alignment = "motion" | "clock";

/** What is compared with the mission that is shown. */
export interface Comparison {
  readonly store: MissionStore;
  readonly align: Alignment;
}

export const ComparisonContext = createContext<Comparison | null>(null);

export const useComparison = (): Comparison | null => useContext(ComparisonContext);

/** The second recording as it is drawn. */
export interface Compared {
  readonly series: Series;
  /** Added to its times, seconds. */
  readonly shift: number;
}

export function comparedWith(first: Series, second: Series, align: Alignment): Compared {
  return { series: second, shift: align === "clock" ? 0 : first.firstMotion - second.firstMotion };
}

/** The value at a time of the first one's clock; NaN where the second one was not recorded. */
export function comparedAt({ series, shift }: Compared, quantity: QuantityName, time: number): number {
  const row = series.rowAt(time - shift - 1e-9);
  return row >= series.length || time - shift < series.at("time", 0) - 1e-9 ? Number.NaN : series.at(quantity, row);
}

/** Times and values within a range of the first one's clock. */
export function comparedSlice({ series, shift }: Compared, range: Range, quantities: readonly QuantityName[]): [Float64Array, Float64Array[]] {
  const from = Math.max(0, series.rowAt(range.from - shift) - 1);
  const to = Math.min(series.length, series.rowAt(range.to - shift) + 1);
  const times = series.slice("time", from, to).map((time) => time + shift);
  return [times, quantities.map((quantity) => series.slice(quantity, from, to))];
}

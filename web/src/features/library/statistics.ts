/** What many runs say together: pure functions from runs to figures. */
import type { Outcome, RunSummary } from "../../api/types";
import { MILLIMETRES } from "../../units/units";

export interface Measure {
  readonly name: string;
  /** In the glossary. */
  readonly term: string;
  readonly decimals: number;
  /** Null where a run has none. */
  readonly of: (run: RunSummary) => number | null;
}

const ofOutcome =
  (read: (outcome: Outcome) => number | null) =>
  ({ outcome }: RunSummary): number | null =>
    outcome === null ? null : read(outcome);

export const MEASURES: readonly Measure[] = [
  { name: "Peak force, N", term: "peak_tip_force", decimals: 3, of: ofOutcome(({ peak_tip_force: peak }) => peak) },
  { name: "Peak to closure, N", term: "peak_tip_force_to_closure", decimals: 3, of: ofOutcome(({ peak_tip_force_to_closure: peak }) => peak) },
  { name: "Cage margin, mm", term: "cage_margin", decimals: 1, of: ofOutcome(({ cage_margin: margin }) => (margin === null ? null : margin * MILLIMETRES.factor)) },
  { name: "Time to closure, s", term: "closed_at", decimals: 2, of: ofOutcome(({ closed_at: at }) => at) },
  { name: "Capture, s", term: "duration", decimals: 2, of: ofOutcome(({ duration }) => duration) },
  { name: "Touches", term: "touches", decimals: 1, of: ofOutcome(({ contacts }) => contacts.length) },
  { name: "Final spin, rad/s", term: "final_target_spin", decimals: 3, of: ofOutcome(({ final_target_spin: spin }) => spin) },
  { name: "Least manipulability, m²", term: "min_manipulability", decimals: 4, of: ofOutcome(({ min_manipulability: least }) => least) },
];

export interface Figures {
  readonly measure: Measure;
  /** Runs that have it. */
  readonly count: number;
  readonly mean: number;
  /** Of the sample, with n - 1; NaN of a single run. */
  readonly deviation: number;
  readonly least: number;
  readonly low: number;
  readonly median: number;
  readonly high: number;
  readonly largest: number;
}

/** That part of sorted values is at most so large, between neighbours by their distance. */
export function quantile(sorted: readonly number[], share: number): number {
  const place = share * (sorted.length - 1);
  const below = sorted[Math.floor(place)] ?? Number.NaN;
  const above = sorted[Math.ceil(place)] ?? Number.NaN;
  return below + (place - Math.floor(place)) * (above - below);
}

function figuresOf(measure: Measure, runs: readonly RunSummary[]): Figures | null {
  const values = runs.map(measure.of).filter((value) => value !== null && Number.isFinite(value)) as number[];
  if (values.length === 0) return null;
  values.sort((one, other) => one - other);
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const squares = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
  const at = (share: number): number => quantile(values, share);
  return { measure, count: values.length, mean, deviation: values.length > 1 ? Math.sqrt(squares / (values.length - 1)) : Number.NaN, least: at(0), low: at(0.05), median: at(0.5), high: at(0.95), largest: at(1) };
}

/** Of every measure that one of the runs has. */
export const statisticsOf = (runs: readonly RunSummary[]): Figures[] => MEASURES.map((measure) => figuresOf(measure, runs)).filter((figures) => figures !== null);

/** Wilson's interval of a share at 95 %. */
export function wilson(count: number, total: number): readonly [low: number, high: number] {
  const z = 1.959964;
  const share = count / total;
  const middle = (share + z ** 2 / (2 * total)) / (1 + z ** 2 / total);
  const half = (z * Math.sqrt((share * (1 - share)) / total + z ** 2 / (4 * total ** 2))) / (1 + z ** 2 / total);
  return [Math.max(0, middle - half), Math.min(1, middle + half)];
}

export interface VerdictShare {
  readonly outcome: Outcome["outcome"];
  readonly count: number;
  /** Of the runs with a verdict. */
  readonly total: number;
  readonly low: number;
  readonly high: number;
}

/** How often each verdict came, the most frequent first; runs without one are left out. */
export function verdictsOf(runs: readonly RunSummary[]): VerdictShare[] {
  const counts = new Map<Outcome["outcome"], number>();
  for (const { outcome } of runs) if (outcome !== null) counts.set(outcome.outcome, (counts.get(outcome.outcome) ?? 0) + 1);
  const total = [...counts.values()].reduce((sum, count) => sum + count, 0);
  return [...counts]
    .sort((one, other) => other[1] - one[1])
    .map(([outcome, count]) => {
      const [low, high] = wilson(count, total);
      return { outcome, count, total, low, high };
    });
}

/** Two studies beside one another: how often each class came in both, and where the measures of both lie. */
import type { StudyDetail, StudyRow } from "../../api/types";
import { inOrder } from "../glossary/class-style";
import { quantile } from "./marginals";
import type { Rows } from "./use-study";

export interface ClassPair {
  readonly name: string;
  /** Shares of the cells that have an outcome. */
  readonly one: number;
  readonly other: number;
}

/** Every class that came in either of them, best first. */
export function classPairs(one: Pick<StudyDetail, "outcomes">, other: Pick<StudyDetail, "outcomes">): readonly ClassPair[] {
  const shareIn = ({ outcomes }: Pick<StudyDetail, "outcomes">, name: string): number => outcomes.find(({ outcome }) => outcome === name)?.share ?? 0;
  const names = inOrder(new Set([...one.outcomes, ...other.outcomes].map(({ outcome }) => outcome)));
  return names.map((name) => ({ name, one: shareIn(one, name), other: shareIn(other, name) }));
}

/** Median and 95 % quantile. */
export interface Level {
  readonly median: number;
  readonly high: number;
}

export interface MeasurePair {
  readonly name: string;
  readonly unit: string;
  readonly one: Level;
  readonly other: Level;
}

/** The measures that a person compares first. */
const MEASURES = ["peak_tip_force", "cage_margin", "duration", "base_turn", "final_target_spin", "min_manipulability"];

function levelOf(rows: Iterable<StudyRow>, name: string): Level | null {
  const values = [...rows].map((row) => row[name]).filter((value) => typeof value === "number").sort((a, b) => a - b);
  return values.length === 0 ? null : { median: quantile(values, 0.5), high: quantile(values, 0.95) };
}

/** Of the measures that both have values of. */
export function measurePairs(columns: StudyDetail["columns"], one: Rows, other: Rows): readonly MeasurePair[] {
  return MEASURES.flatMap((name) => {
    const unit = columns.find((column) => column.name === name)?.unit;
    const [ours, theirs] = [levelOf(one.values(), name), levelOf(other.values(), name)];
    return unit === undefined || ours === null || theirs === null ? [] : [{ name, unit, one: ours, other: theirs }];
  });
}

/** What is common to both, so that one colour means one number in either picture; null where neither has a number. */
export function commonRange(ranges: readonly (readonly [number, number] | null)[]): readonly [number, number] | null {
  const known = ranges.filter((range) => range !== null);
  return known.length === 0 ? null : [Math.min(...known.map(([low]) => low)), Math.max(...known.map(([, high]) => high))];
}

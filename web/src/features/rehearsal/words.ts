/** What a rehearsal says, as a person reads it. */
import type { Decider, Odds, RehearsalCase, RehearsalDetail, RehearsalResult } from "../../api/types";
import { fixed, plain, shown, type AngleUnit } from "../../units/units";
import { classStyle } from "../glossary/class-style";

export const CASES = ["as_it_is", "as_changed"] as const;
export type CaseName = (typeof CASES)[number];

export const CASE_WORDS: Readonly<Record<CaseName, string>> = { as_it_is: "As it is", as_changed: "As changed" };

export interface NamedCase {
  readonly name: CaseName;
  readonly of: RehearsalCase;
}

/** As it is, and as changed where something was. */
export const casesOf = (result: RehearsalResult): NamedCase[] =>
  CASES.flatMap((name): NamedCase[] => {
    const of = result[name];
    return of === null ? [] : [{ name, of }];
  });

const percent = (share: number): string => fixed(100 * share, 0);

/** Such as "97 of 100 caged, 92 to 99 %": the range is Wilson's at 95 %. */
export const oddsWords = ({ outcome, futures, low, high }: Odds, total: number): string => `${futures} of ${total} ${classStyle(outcome).words}, ${percent(low)} to ${percent(high)} %`;

export const requestWords = (request: string | null): string => {
  if (request === null) return "What is under way";
  const words = request.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};

/** In at most four figures. */
export const figures = (value: number): string => plain(Number(value.toPrecision(Math.abs(value) >= 1000 ? 4 : 3)));

/** A band on the common scale of its measure: parts of its width, 0 to 1. */
export interface Range {
  readonly case: CaseName;
  readonly low: number;
  readonly median: number;
  readonly high: number;
  /** Such as "0.165 (0.132 to 0.254)", in the unit of its measure. */
  readonly words: string;
}

export interface MeasureRanges {
  readonly measure: string;
  readonly title: string;
  readonly unit: string;
  readonly description: string;
  readonly ranges: readonly Range[];
}

export const MEASURE_TITLES: Readonly<Record<string, string>> = {
  peak_tip_force: "Peak force, to locked arms",
  peak_tip_force_to_closure: "Peak force, to closure",
  time_to_cage: "Time to cage",
  base_turn: "Base rotation",
  min_manipulability: "Least manipulability",
};

const MEASURES = Object.keys(MEASURE_TITLES);

/** Room beside the widest band, so that a lone one is seen as one. */
const AIR = 0.15;

/** What a track of these values shows: from zero, unless that would squeeze them into a corner. */
export function scaleOf(values: readonly number[]): readonly [number, number] {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const air = AIR * Math.max(high - low, 1e-3 * Math.abs(high), 1e-12);
  return low >= 0 && low < 0.75 * high ? [0, high + air] : [low - air, high + air];
}

function rangesOfMeasure(measure: string, cases: readonly NamedCase[], angles: AngleUnit): MeasureRanges[] {
  const bands = cases.flatMap(({ name, of }) => of.bands.filter((band) => band.measure === measure).map((band) => ({ name, band })));
  const first = bands[0]?.band;
  if (first === undefined) return [];
  const { factor, unit } = shown(first.unit, angles);
  const [from, to] = scaleOf(bands.flatMap(({ band }) => [band.low, band.high]));
  const part = (value: number): number => (value - from) / (to - from);
  const text = (value: number): string => figures(value * factor);
  const ranges = bands.map(({ name, band }) => ({
    case: name,
    low: part(band.low),
    median: part(band.median),
    high: part(band.high),
    words: `${text(band.median)} (${text(band.low)} to ${text(band.high)})`,
  }));
  return [{ measure, title: MEASURE_TITLES[measure] ?? measure, unit, description: first.description, ranges }];
}

/** 5, 50 and 95 % of each measure that any future has, all cases of a measure on one scale. */
export const rangesOf = (result: RehearsalResult, angles: AngleUnit): MeasureRanges[] => MEASURES.flatMap((measure) => rangesOfMeasure(measure, casesOf(result), angles));

export interface Deciding {
  /** What the correlation is with. */
  readonly with: "caged" | "peak force";
  readonly rows: readonly { readonly name: string; readonly description: string; readonly value: number }[];
}

const DECIDERS = 5;

/** What the outcome hangs on most where outcomes differ, else what the force hangs on; null where nothing can be said. */
export function decidingOf({ deciding, caged }: RehearsalCase): Deciding | null {
  const mixed = caged.futures > 0 && caged.share < 1 && deciding.some((each) => each.with_caged !== null);
  const of = ({ with_caged, with_peak_force }: Decider): number | null => (mixed ? with_caged : with_peak_force);
  const rows = deciding
    .flatMap((each) => {
      const value = of(each);
      return value === null ? [] : [{ name: each.name.replaceAll("_", " "), description: each.description, value }];
    })
    .sort((one, other) => Math.abs(other.value) - Math.abs(one.value))
    .slice(0, DECIDERS);
  return rows.length === 0 ? null : { with: mixed ? "caged" : "peak force", rows };
}

/** How far one is that flies, and why one ended without a result. */
export function statusWords({ status, note, progress }: RehearsalDetail): string {
  if (status === "queued") return "Waiting for its turn, or being prepared";
  // The first futures after an update wait for its code; two seconds are far more than they take otherwise.
  if (status === "running" && progress.done === 0 && progress.wall_time > 2) return `Compiling the controller, once after an update: up to a minute; ${fixed(progress.wall_time, 0)} s so far`;
  if (status === "running") return `${progress.done} of ${progress.total} futures, ${fixed(progress.wall_time, 1)} s`;
  if (status === "finished") return `${progress.total} futures in ${fixed(progress.wall_time, 1)} s`;
  const word = status.charAt(0).toUpperCase() + status.slice(1);
  return note === null ? `${word}.` : `${word}: ${note}`;
}

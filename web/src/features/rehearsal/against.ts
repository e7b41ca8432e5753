/** Predicted against real: what the futures of a rehearsal said of a run, beside what came of it. */
import type { Band, Outcome, RehearsalResult } from "../../api/types";
import type { Series } from "../../source/series";
import { shown, type AngleUnit } from "../../units/units";
import { classStyle } from "../glossary/class-style";
import { figures, MEASURE_TITLES, oddsWords, scaleOf, type CaseName } from "./words";

/** A future goes on for so long after the arms have locked, seconds: until then the base's rotation counts. */
const SETTLE = 0.5;

export interface Against {
  readonly measure: string;
  readonly title: string;
  readonly unit: string;
  /** Median and 5 to 95 %. */
  readonly predicted: string;
  readonly real: string;
  /** Of a track that has them all: parts of its width, 0 to 1. */
  readonly places: { readonly low: number; readonly median: number; readonly high: number; readonly real: number | null };
  /** Whether it came out between 5 and 95 %; null where there is nothing real. */
  readonly within: boolean | null;
}

/** The largest size of the base's angle between two moments. */
function largestTurn(series: Series, from: number, to: number): number | null {
  let turn: number | null = null;
  for (let row = series.rowAt(from); row < series.length && series.at("time", row) <= to; row += 1) {
    const angle = Math.abs(series.at("baseAngle", row));
    if (Number.isFinite(angle)) turn = Math.max(turn ?? 0, angle);
  }
  return turn;
}

/** What a measure of the futures came to in the run. */
function realOf(measure: string, outcome: Outcome, series: Series, begun: number): number | null {
  switch (measure) {
    case "peak_tip_force":
      return outcome.peak_tip_force;
    case "peak_tip_force_to_closure":
      return outcome.peak_tip_force_to_closure;
    case "min_manipulability":
      return outcome.min_manipulability;
    case "time_to_cage":
      return outcome.closed_at === null ? null : outcome.closed_at - begun;
    case "base_turn":
      return largestTurn(series, begun, outcome.locked_at === null ? Infinity : outcome.locked_at + SETTLE);
    default:
      return null;
  }
}

/** As it is read: what nobody can see is no difference. */
const read = (value: number): number => Number(value.toPrecision(3));

function rowOf({ measure, unit: si, low, median, high }: Band, real: number | null, angles: AngleUnit): Against {
  const { factor, unit } = shown(si, angles);
  const text = (value: number): string => figures(value * factor);
  const [from, to] = scaleOf([low, high, real ?? low]);
  const place = (value: number): number => (value - from) / (to - from);
  return {
    measure,
    title: MEASURE_TITLES[measure] ?? measure,
    unit,
    predicted: `${text(median)} (${text(low)} to ${text(high)})`,
    real: real === null ? "—" : text(real),
    places: { low: place(low), median: place(median), high: place(high), real: real === null ? null : place(real) },
    within: real === null ? null : read(real) >= read(low) && read(real) <= read(high),
  };
}

/** @param begun when the sequence that was rehearsed began in the run, mission time in seconds */
export function againstOf(result: RehearsalResult, name: CaseName, outcome: Outcome, series: Series, begun: number, angles: AngleUnit): Against[] {
  const { bands } = result[name] ?? result.as_it_is;
  return Object.keys(MEASURE_TITLES).flatMap((measure) => {
    const band = bands.find((each) => each.measure === measure);
    return band === undefined ? [] : [rowOf(band, realOf(measure, outcome, series, begun), angles)];
  });
}

/** With what odds the outcome was predicted that came. */
export function oddsAgainst(result: RehearsalResult, name: CaseName, { outcome }: Outcome): string {
  const { odds, futures } = result[name] ?? result.as_it_is;
  const predicted = odds.find((each) => each.outcome === outcome);
  return predicted === undefined ? `none of ${futures} futures: ${classStyle(outcome).words}` : oddsWords(predicted, futures);
}

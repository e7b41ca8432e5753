/** What a rehearsal predicted, over the clock of the mission that is shown. */
import { createContext, useContext } from "react";
import type { QuantityName } from "../../source/quantities";
import type { PhaseSpan, Series } from "../../source/series";

/** Between which values 90 % of the futures are, over mission time; in SI. */
export interface PredictedBand {
  readonly times: readonly number[];
  readonly low: readonly number[];
  readonly median: readonly number[];
  readonly high: readonly number[];
}

export interface Prediction {
  /** Such as "as it is". */
  readonly words: string;
  /** Mission time of the state that the futures begin in, seconds. */
  readonly from: number;
  /** Whether they begin with a request, which may be given later than it was rehearsed. */
  readonly requested: boolean;
  readonly bands: ReadonlyMap<QuantityName, PredictedBand>;
  /** Takes it out of the plots; null where it belongs to what is shown. */
  readonly dismiss: (() => void) | null;
}

export const PredictionContext = createContext<Prediction | null>(null);

export const usePrediction = (): Prediction | null => useContext(PredictionContext);

/** The quantities of a rehearsal that are plotted, by their names there. */
const QUANTITIES: Readonly<Record<string, QuantityName>> = {
  "target.twist.angle": "spin",
  "base.pose.angle": "baseAngle",
  "left.force": "leftForce",
  "right.force": "rightForce",
  "left.manipulability": "leftManipulability",
  "right.manipulability": "rightManipulability",
};

/** The bands of those quantities that are plotted. */
export const bandsOf = (fans: readonly (PredictedBand & { readonly quantity: string })[]): ReadonlyMap<QuantityName, PredictedBand> =>
  new Map(
    fans.flatMap((fan): [QuantityName, PredictedBand][] => {
      const name = QUANTITIES[fan.quantity];
      return name === undefined ? [] : [[name, fan]];
    }),
  );

/** Moments of one tick and of the one before it are the same for a person. */
const TICK = 2e-3;

/**
 * What is added to the times of a prediction, seconds.
 *
 * Until its request is given it lies ahead of now; from then on it stays where the sequence began.
 */
export function shiftOf({ from, requested }: Pick<Prediction, "from" | "requested">, phases: readonly PhaseSpan[], now: number): number {
  if (!requested) return 0;
  const present = phases.findLast(({ start }) => start <= from + TICK)?.phase;
  const begun = phases.find(({ start, phase }) => start > from + TICK && phase !== present);
  return Math.max(0, (begun?.start ?? now) - from);
}

/** A prediction where it is drawn. */
export interface Placed {
  readonly prediction: Prediction;
  /** Added to its times, seconds. */
  readonly shift: number;
  /** Mission time of its last moment, seconds. */
  readonly end: number;
}

export function placedIn(prediction: Prediction | null, series: Series, now: number): Placed | null {
  if (prediction === null) return null;
  const shift = shiftOf(prediction, series.phaseSpans(), now);
  const ends = [...prediction.bands.values()].map(({ times }) => times.at(-1) ?? 0);
  return { prediction, shift, end: Math.max(prediction.from, ...ends) + shift };
}

/** The least and the greatest predicted value within a stretch of time; null for none. */
export function extentOf({ times, low, high }: PredictedBand, shift: number, from: number, to: number): readonly [number, number] | null {
  let [least, most] = [Infinity, -Infinity];
  for (const [place, time] of times.entries()) {
    if (time + shift < from || time + shift > to) continue;
    least = Math.min(least, low[place] ?? Infinity);
    most = Math.max(most, high[place] ?? -Infinity);
  }
  return least <= most ? [least, most] : null;
}

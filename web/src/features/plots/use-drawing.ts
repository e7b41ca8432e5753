/** Draws all plots from the browser's animation frames, when there is something new and time to spare. */
import { useCallback, useEffect, useRef, type RefObject } from "react";
import type { Series } from "../../source/series";
import { useStore } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { clock } from "../../units/units";
import { comparedWith, useComparison, type Compared, type Comparison } from "./compared";
import { seriesFor, type Detail } from "./detail";
import { Pace } from "./pace";
import { placedIn, usePrediction, type Placed, type Prediction } from "./prediction";
import type { DrawPlot, PlotFrame } from "./Plot";
import { rangeOf, type TimeView } from "./timeview";

interface Drawing {
  /** Adds a plot; the returned function takes it away. */
  readonly register: (draw: DrawPlot) => () => void;
  /** Something other than the data asks for a new drawing. */
  readonly touch: () => void;
}

/** What was asked for more finely than the whole shows it. */
export interface Details {
  readonly own: Detail | null;
  readonly compared: Detail | null;
}

interface Shown {
  readonly view: TimeView;
  readonly details: Details;
  readonly comparison: Comparison | null;
  readonly prediction: Prediction | null;
}

const endOf = (series: Series): number => series.at("time", series.length - 1) || 0;

function frameOf(store: MissionStore, { view, details, comparison, prediction }: Shown): PlotFrame {
  const { series, source } = store;
  const { snapshot, config, touches } = store.read();
  const other = comparison && comparedWith(series, comparison.store.series, comparison.align);
  const now = Math.max(endOf(series), other === null ? 0 : endOf(other.series) + other.shift);
  const predicted = placedIn(prediction, series, endOf(series));
  const range = rangeOf(view, now, series.firstMotion, aheadOf(predicted, now));
  const compared: Compared | null = other && {
    shift: other.shift,
    series: seriesFor(details.compared, { from: range.from - other.shift, to: range.to - other.shift }, other.series),
  };
  return {
    series: seriesFor(details.own, range, series),
    whole: series,
    compared,
    predicted,
    range,
    known: { snapshot, config },
    decorations: { phases: series.phaseSpans(), touches, moment: source.playback?.read().time ?? null },
  };
}

/** Seconds that are predicted ahead of now. */
export const aheadOf = (placed: Placed | null, now: number): number => (placed === null ? 0 : placed.end - now);

/** @param time shows the mission time under the cursor. */
export function useDrawing(view: TimeView, details: Details, time: RefObject<HTMLElement | null>): Drawing {
  const store = useStore();
  const comparison = useComparison();
  const prediction = usePrediction();
  const draws = useRef(new Set<DrawPlot>());
  const dirty = useRef(true);

  useEffect(() => {
    const pace = new Pace();
    const version = (): number => store.series.version + (comparison?.store.series.version ?? 0);
    let drawn = -1;
    let request = 0;
    dirty.current = true;
    const frame = (now: number): void => {
      request = requestAnimationFrame(frame);
      const news = version() !== drawn && view.pausedAt === null;
      if (!(news || dirty.current) || !pace.due(now) || time.current?.checkVisibility() === false) return;
      const begun = performance.now();
      dirty.current = false;
      drawn = version();
      const content = frameOf(store, { view, details, comparison, prediction });
      let moment: number | null = null;
      for (const draw of draws.current) moment = draw(content) ?? moment;
      if (time.current) time.current.textContent = moment === null ? "" : `at ${clock(moment)}`;
      pace.drew(now, performance.now() - begun);
    };
    request = requestAnimationFrame(frame);
    const withdraw = store.source.playback?.subscribe(() => {
      dirty.current = true;
    });
    return () => {
      withdraw?.();
      cancelAnimationFrame(request);
    };
  }, [store, view, details, time, comparison, prediction]);

  const touch = useCallback(() => {
    dirty.current = true;
  }, []);
  const register = useCallback((draw: DrawPlot) => {
    draws.current.add(draw);
    dirty.current = true;
    return () => {
      draws.current.delete(draw);
    };
  }, []);
  return { register, touch };
}

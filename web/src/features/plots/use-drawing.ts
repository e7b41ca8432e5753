/** Draws all plots from the browser's animation frames, when there is something new and time to spare. */
import { useCallback, useEffect, useRef, type RefObject } from "react";
import type { Series } from "../../source/series";
import { useStore } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { clock } from "../../units/units";
import { comparedWith, useComparison, type Compared, type Comparison } from "./compared";
import { seriesFor, type Detail } from "./detail";
import { Frames } from "./frames";
import { Pace } from "./pace";
import { placedIn, usePrediction, type Placed, type Prediction } from "./prediction";
import type { DrawPlot, PlotFrame } from "./Plot";
import { write } from "./write";
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

/** Phases in which nothing moves but the time axis. */
const RESTS: ReadonlySet<string> = new Set(["idle", "stopped", "faulted"]);

/** @param time shows the mission time under the cursor. */
export function useDrawing(view: TimeView, details: Details, time: RefObject<HTMLElement | null>): Drawing {
  const store = useStore();
  const comparison = useComparison();
  const prediction = usePrediction();
  const draws = useRef(new Set<DrawPlot>());
  const wanted = useRef<() => void>(() => undefined);

  useEffect(() => {
    const frames = new Frames(time.current?.closest("section") ?? null);
    const pace = new Pace();
    const atRest = (): boolean => comparison === null && store.source.playback === null && RESTS.has(store.read().snapshot?.phase ?? "");
    frames.draw = (now) => {
      const begun = performance.now();
      const content = frameOf(store, { view, details, comparison, prediction });
      let moment: number | null = null;
      for (const draw of draws.current) moment = draw(content) ?? moment;
      write(time.current, moment === null ? "" : `at ${clock(moment)}`);
      pace.drew(now, performance.now() - begun);
    };
    wanted.current = () => { frames.ask(pace.wait(performance.now(), false)); };
    const news = (): void => {
      if (view.pausedAt === null) frames.ask(pace.wait(performance.now(), atRest()));
    };
    const withdraw = [store.series.subscribe(news), comparison?.store.series.subscribe(news), store.source.playback?.subscribe(wanted.current)];
    wanted.current();
    return () => {
      for (const each of withdraw) each?.();
      frames.end();
    };
  }, [store, view, details, time, comparison, prediction]);

  const touch = useCallback(() => {
    wanted.current();
  }, []);
  const register = useCallback((draw: DrawPlot) => {
    draws.current.add(draw);
    wanted.current();
    return () => {
      draws.current.delete(draw);
    };
  }, []);
  return { register, touch };
}

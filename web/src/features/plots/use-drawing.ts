/** Draws all plots from the browser's animation frames, when there is something new and time to spare. */
import { useCallback, useEffect, useRef, type RefObject } from "react";
import { useStore } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { clock } from "../../units/units";
import type { Player } from "../replay/player";
import { Pace } from "./pace";
import type { DrawPlot, PlotFrame } from "./Plot";
import { useCompared, type Compared } from "./compared";
import { seriesFor, type Detail } from "./detail";
import type { Known } from "./plot-set";
import { rangeOf, type Range, type TimeView } from "./timeview";

interface Drawing {
  /** Adds a plot; the returned function takes it away. */
  readonly register: (draw: DrawPlot) => () => void;
  /** Something other than the data asks for a new drawing. */
  readonly touch: () => void;
}

/** What was asked for more finely than the whole of a recording shows it. */
export interface Details {
  readonly own: Detail | null;
  readonly compared: Detail | null;
}

interface Shown {
  readonly view: TimeView;
  readonly details: Details;
  readonly config: Known["config"];
  readonly player: Player | null;
  readonly compared: Compared | null;
}

/** The second recording as finely as there is, in its own clock. */
function comparedFor(compared: Compared | null, detail: Detail | null, { from, to }: Range): Compared | null {
  if (compared === null) return null;
  const { shift, series } = compared;
  return { ...compared, series: seriesFor(detail, { from: from - shift, to: to - shift }, series) };
}

function frameOf(store: MissionStore, { view, details, config, player, compared }: Shown): PlotFrame {
  const { series } = store;
  const { snapshot } = store.read();
  const end = (of: MissionStore["series"]): number => of.at("time", of.length - 1) || 0;
  const now = Math.max(end(series), compared === null ? 0 : end(compared.series) + compared.shift);
  const range = rangeOf(view, now, series.firstMotion);
  return {
    series: seriesFor(details.own, range, series),
    whole: series,
    compared: comparedFor(compared, details.compared, range),
    range,
    known: { snapshot, config },
    decorations: { phases: series.phaseSpans(), touches: snapshot?.contacts ?? store.touches, moment: player?.read().time ?? null },
  };
}

interface Shared {
  readonly details: Details;
  /** The configuration of what is shown. */
  readonly config: Known["config"];
  /** Of a replay. */
  readonly player: Player | null;
}

/** @param time shows the mission time under the cursor. */
export function useDrawing(view: TimeView, { details, config, player }: Shared, time: RefObject<HTMLElement | null>): Drawing {
  const store = useStore();
  const compared = useCompared();
  const draws = useRef(new Set<DrawPlot>());
  const dirty = useRef(true);

  useEffect(() => {
    const pace = new Pace();
    let drawn = -1;
    let request = 0;
    dirty.current = true;
    const frame = (now: number): void => {
      request = requestAnimationFrame(frame);
      const news = store.series.version !== drawn && view.pausedAt === null;
      if (!(news || dirty.current) || !pace.due(now) || time.current?.checkVisibility() === false) return;
      const begun = performance.now();
      dirty.current = false;
      drawn = store.series.version;
      const content = frameOf(store, { view, details, config, player, compared });
      let moment: number | null = null;
      for (const draw of draws.current) moment = draw(content) ?? moment;
      if (time.current) time.current.textContent = moment === null ? "" : `at ${clock(moment)}`;
      pace.drew(now, performance.now() - begun);
    };
    request = requestAnimationFrame(frame);
    const withdraw = player?.subscribe(() => {
      dirty.current = true;
    });
    return () => {
      withdraw?.();
      cancelAnimationFrame(request);
    };
  }, [store, view, details, config, time, player, compared]);

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

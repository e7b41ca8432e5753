/** Draws all plots from the browser's animation frames, when there is something new and time to spare. */
import { useCallback, useEffect, useRef, type RefObject } from "react";
import { useConfiguration } from "../../store/configuration";
import { useStore } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { clock } from "../../units/units";
import type { Player } from "../replay/player";
import { Pace } from "./pace";
import type { DrawPlot, PlotFrame } from "./Plot";
import { useCompared, type Compared } from "./compared";
import type { Known } from "./plot-set";
import { rangeOf, type TimeView } from "./timeview";

interface Drawing {
  /** Adds a plot; the returned function takes it away. */
  readonly register: (draw: DrawPlot) => () => void;
  /** Something other than the data asks for a new drawing. */
  readonly touch: () => void;
}

function frameOf(store: MissionStore, view: TimeView, config: Known["config"], player: Player | null, compared: Compared | null): PlotFrame {
  const { series } = store;
  const { snapshot } = store.read();
  const end = (of: MissionStore["series"]): number => of.at("time", of.length - 1) || 0;
  const now = Math.max(end(series), compared === null ? 0 : end(compared.series) + compared.shift);
  return {
    series,
    compared,
    range: rangeOf(view, now, series.firstMotion),
    known: { snapshot, config },
    decorations: { phases: series.phaseSpans(), touches: snapshot?.contacts ?? store.touches, moment: player?.read().time ?? null },
  };
}

/** @param time shows the mission time under the cursor; @param player of a replay. */
export function useDrawing(view: TimeView, time: RefObject<HTMLElement | null>, player: Player | null): Drawing {
  const store = useStore();
  const compared = useCompared();
  const config = useConfiguration().inForce?.config ?? null;
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
      if (!(news || dirty.current) || !pace.due(now)) return;
      const begun = performance.now();
      dirty.current = false;
      drawn = store.series.version;
      const content = frameOf(store, view, config, player, compared);
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
  }, [store, view, config, time, player, compared]);

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

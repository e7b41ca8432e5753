/** The mission over time: every plot on one clock and one cursor. */
import { Button, SegmentedControl } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import { useMemo, useRef, useState } from "react";
import { Panel } from "../../ui/Panel";
import { useKept } from "../../ui/use-kept";
import type { Run } from "../../api/types";
import { useConfiguration } from "../../store/configuration";
import { useSnapshot, useStore } from "../../store/context";
import { Icon } from "../../ui/theme/Icon";
import type { Player } from "../replay/player";
import type { ChartEvents } from "./chart";
import { useCompared } from "./compared";
import { useDetail } from "./detail";
import type { FigureSource } from "./figure-of";
import { Plot } from "./Plot";
import styles from "./PlotPanel.module.css";
import { BESIDE, PAIR_NAMES, PAIRS } from "./plot-set";
import { chosen, FOLLOW, rangeOf, zoomedAbout, type TimeView, type Window } from "./timeview";
import { useDrawing } from "./use-drawing";
import { useTruePeaks } from "./use-true-peaks";

/** Room for all plots at once. */
const WIDE = "(min-width: 1700px)";

interface ToolsProps {
  readonly view: TimeView;
  readonly change: (view: TimeView) => void;
  readonly now: () => number;
  readonly recorded: boolean;
}

function Tools({ view, change, now, recorded }: ToolsProps) {
  const still = view.pausedAt !== null;
  return (
    <div className={styles.tools}>
      {view.zoomed && (
        <Button
          size="compact-xs"
          leftSection={<Icon sign="follow" size={12} />}
          onClick={() => {
            change({ ...view, zoomed: null });
          }}
        >
          {recorded ? "Whole run" : "Follow"}
        </Button>
      )}
      {!recorded && <Button
        size="compact-xs"
        aria-pressed={still}
        leftSection={<Icon sign={still ? "play" : "pause"} size={12} />}
        onClick={() => {
          change({ ...view, pausedAt: still ? null : now() });
        }}
      >
        {still ? "Resume plots" : "Pause plots"}
      </Button>}
      <SegmentedControl
        aria-label="Stretch of time"
        value={String(view.window)}
        data={[
          { value: "10", label: "10 s" },
          { value: "30", label: "30 s" },
          { value: "0", label: "All" },
        ]}
        onChange={(value) => {
          change({ ...view, zoomed: null, window: Number(value) as Window });
        }}
      />
    </div>
  );
}

function interleaved<Item>(one: readonly Item[], other: readonly Item[]): Item[] {
  return one.flatMap((item, place) => [item, ...other.slice(place, place + 1)]);
}

/** Seconds behind the newest tick within which a run in progress may not be on disk yet. */
const ON_DISK = 2;

/** Asks for the stretch that is looked at closely, of both runs. */
function useDetails(view: TimeView, run: string | null, recorded: boolean) {
  const { series } = useStore();
  const compared = useCompared();
  const end = series.at("time", series.length - 1) || 0;
  const close = view.zoomed ?? (recorded && view.window > 0 ? rangeOf(view, end, series.firstMotion) : null);
  const own = useDetail(run, close !== null && (recorded || close.to < end - ON_DISK) ? close : null);
  const shift = compared?.shift ?? 0;
  const theirs = useDetail(compared?.run ?? null, close && { from: Math.max(0, close.from - shift), to: Math.max(0, close.to - shift) });
  return useMemo(() => ({ own, compared: theirs }), [own, theirs]);
}

function useSource(run: Run | null, live: string | null): FigureSource {
  const other = useCompared()?.run ?? null;
  return useMemo(() => {
    const words = run === null ? `Run ${live ?? "that is not recorded"}, in progress` : `Run ${run.id}, ${run.configuration}, seed ${run.seed}`;
    return { words, other, file: `becalm-${run?.id ?? live ?? "mission"}` };
  }, [run, live, other]);
}

export interface Replayed {
  readonly run: Run;
  readonly player: Player;
}

/** Of a mission that flies, or of a recording with its player: then the whole of it, which nothing moves on. */
export function PlotPanel({ replayed = null }: { readonly replayed?: Replayed | null }) {
  const recorded = replayed !== null;
  const player = replayed?.player ?? null;
  const live = useSnapshot((snapshot) => snapshot.run_id);
  const { series } = useStore();
  const [view, setView] = useState<TimeView>(recorded ? { ...FOLLOW, window: 0 } : FOLLOW);
  const [pair, setPair] = useKept("becalm-plots", "contact", PAIR_NAMES);
  const wide = useMediaQuery(WIDE, window.matchMedia(WIDE).matches);
  // The grid is filled row by row, so that each pair stands in a column of its own.
  const plots = wide ? interleaved(PAIRS[pair].plots, PAIRS[BESIDE[pair]].plots) : PAIRS[pair].plots;
  const lowest = plots.length - (wide ? 2 : 1);
  const time = useRef<HTMLSpanElement>(null);
  const now = (): number => Math.max(0, series.at("time", series.length - 1) || 0);
  const inForce = useConfiguration().inForce?.config ?? null;
  const details = useDetails(view, replayed?.run.id ?? live, recorded);
  const source = useSource(replayed?.run ?? null, live);
  const { register, touch } = useDrawing(view, { details, config: replayed?.run.config ?? inForce, player }, time);
  useTruePeaks(!recorded, time);

  const events = useMemo<ChartEvents>(() => {
    const latest = (): number => series.at("time", series.length - 1) || 0;
    return {
      select: (one, other) => {
        setView((old) => ({ ...old, zoomed: chosen(one, other) }));
      },
      follow: () => {
        setView((old) => ({ ...old, zoomed: null }));
      },
      wheel: (moment, factor) => {
        setView((old) => ({ ...old, zoomed: zoomedAbout(rangeOf(old, latest(), series.firstMotion), moment, factor) }));
      },
      moment: (moment) => {
        player?.seek(moment);
      },
      cursor: touch,
    };
  }, [series, touch, player]);

  const aside = (
    <>
      <span ref={time} className={styles.time} />
      <SegmentedControl
        aria-label="Plots shown"
        value={pair}
        data={PAIR_NAMES.map((name) => ({ value: name, label: PAIRS[name].label }))}
        onChange={(name) => {
          setPair(name);
        }}
      />
      <Tools view={view} change={setView} now={now} recorded={recorded} />
    </>
  );
  return (
    <div className={styles.place}>
      <Panel title="Plots" grow dated={recorded ? undefined : "robot"} aside={aside}>
        <div className={styles.plots}>
          {plots.map((definition, place) => (
            <Plot key={definition.id} definition={definition} timed={place >= lowest} events={events} source={source} register={register} />
          ))}
        </div>
      </Panel>
    </div>
  );
}

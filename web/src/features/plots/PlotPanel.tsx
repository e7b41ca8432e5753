/** The mission over time: every plot on one clock and one cursor. */
import { ActionIcon, SegmentedControl } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import { useEffect, useMemo, useRef, useState, type Dispatch, type SetStateAction } from "react";
import { useStore, useView, useViewOf } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { keepMoment, momentOf } from "../../store/moment";
import { subscribe } from "../../store/route";
import { useRefresh } from "../../store/use-refresh";
import { Panel } from "../../ui/Panel";
import { Icon } from "../../ui/theme/Icon";
import { useKept } from "../../ui/use-kept";
import type { ChartEvents } from "./chart";
import { comparedWith, useComparison } from "./compared";
import { useDetail } from "./detail";
import type { FigureSource } from "./figure-of";
import { Plot } from "./Plot";
import styles from "./PlotPanel.module.css";
import { PlotTools } from "./PlotTools";
import { placedIn, usePrediction, type Prediction } from "./prediction";
import { BESIDE, PAIR_NAMES, PAIRS } from "./plot-set";
import { chosen, FOLLOW, rangeOf, zoomedAbout, type TimeView } from "./timeview";
import { aheadOf, useDrawing, type Details } from "./use-drawing";

/** Room for all plots at once. */
const WIDE = "(min-width: 1700px)";

function interleaved<Item>(one: readonly Item[], other: readonly Item[]): Item[] {
  return one.flatMap((item, place) => [item, ...other.slice(place, place + 1)]);
}

const newestIn = ({ series }: MissionStore): number => series.at("time", series.length - 1) || 0;

/** Asks for the stretch that is looked at closely, of both runs. */
function useDetails(view: TimeView): Details {
  const store = useStore();
  const comparison = useComparison();
  const narrow = store.source.playback !== null && view.window > 0;
  const close = view.zoomed ?? (narrow ? rangeOf(view, newestIn(store), store.series.firstMotion) : null);
  const own = useDetail(store, close);
  const shift = comparison === null ? 0 : comparedWith(store.series, comparison.store.series, comparison.align).shift;
  const theirs = useDetail(comparison?.store ?? null, close && { from: Math.max(0, close.from - shift), to: Math.max(0, close.to - shift) });
  return useMemo(() => ({ own, compared: theirs }), [own, theirs]);
}

/** What a figure says of where its curves come from. */
function useFigureSource(): FigureSource {
  const run = useView((view) => view.run);
  const other = useViewOf(useComparison()?.store ?? null, (view) => view.run?.id ?? null);
  return useMemo(() => ({ words: run?.title ?? "", other, file: `becalm-${run?.id ?? "mission"}` }), [run, other]);
}

/** What the mouse does in every plot. */
function useChartEvents(setView: Dispatch<SetStateAction<TimeView>>, touch: () => void): ChartEvents {
  const store = useStore();
  const prediction = usePrediction();
  return useMemo<ChartEvents>(
    () => ({
      select: (one, other) => {
        setView((old) => ({ ...old, zoomed: chosen(one, other) }));
      },
      follow: () => {
        setView((old) => ({ ...old, zoomed: null }));
      },
      wheel: (moment, factor) => {
        const now = newestIn(store);
        const ahead = aheadOf(placedIn(prediction, store.series, now), now);
        setView((old) => ({ ...old, zoomed: zoomedAbout(rangeOf(old, now, store.series.firstMotion, ahead), moment, factor) }));
      },
      moment: (moment) => {
        store.source.playback?.seek(moment);
      },
      cursor: touch,
    }),
    [store, prediction, setView, touch],
  );
}

/** Which prediction is drawn behind the curves. */
function Predicted({ prediction }: { readonly prediction: Prediction }) {
  const { words, dismiss } = prediction;
  return (
    <span className={styles.predicted} title={`Predicted by the last rehearsal, ${words}: 5 to 95 % of its futures filled, the median dashed. It begins where its request is given.`}>
      <i aria-hidden="true" />
      <span>
        Predicted<span className={styles.case}>{` ${words}`}</span>
      </span>
      {dismiss !== null && (
        <ActionIcon size={16} variant="subtle" color="gray" aria-label="Take the prediction out of the plots" onClick={dismiss}>
          <Icon icon="cross" size={9} />
        </ActionIcon>
      )}
    </span>
  );
}

/** What is shown of a stored run is part of the address, which opens it again. */
function useTimeView(following: boolean): [TimeView, Dispatch<SetStateAction<TimeView>>] {
  const [view, setView] = useState<TimeView>(() => (following ? FOLLOW : { ...FOLLOW, window: 0, zoomed: momentOf(location.hash).range }));
  const { zoomed } = view;
  useEffect(() => {
    if (!following) keepMoment({ range: zoomed });
  }, [following, zoomed]);
  useEffect(() => {
    if (following) return undefined;
    return subscribe(() => {
      const { range } = momentOf(location.hash);
      if (range !== null) setView((old) => ({ ...old, zoomed: range }));
    });
  }, [following]);
  return [view, setView];
}

export function PlotPanel() {
  const prediction = usePrediction();
  const store = useStore();
  const following = store.source.playback === null;
  const [view, setView] = useTimeView(following);
  const [pair, setPair] = useKept("becalm-plots", "contact", PAIR_NAMES);
  const wide = useMediaQuery(WIDE, window.matchMedia(WIDE).matches);
  // The grid is filled row by row, so that each pair stands in a column of its own.
  const plots = wide ? interleaved(PAIRS[pair].plots, PAIRS[BESIDE[pair]].plots) : PAIRS[pair].plots;
  const lowest = plots.length - (wide ? 2 : 1);
  const time = useRef<HTMLSpanElement>(null);
  const details = useDetails(view);
  const source = useFigureSource();
  const { register, touch } = useDrawing(view, details, time);
  const events = useChartEvents(setView, touch);
  const isSeen = (): boolean => time.current?.checkVisibility() === true;
  useRefresh(store, isSeen);
  useRefresh(useComparison()?.store ?? null, isSeen);

  const aside = (
    <>
      {prediction !== null && <Predicted prediction={prediction} />}
      <span ref={time} className={styles.time} />
      <SegmentedControl
        aria-label="Plots shown"
        value={pair}
        data={PAIR_NAMES.map((name) => ({ value: name, label: PAIRS[name].label }))}
        onChange={(name) => {
          setPair(name);
        }}
      />
      <PlotTools view={view} change={setView} now={() => newestIn(store)} following={following} />
    </>
  );
  return (
    <div className={styles.place}>
      <Panel title="Plots" grow dated="robot" aside={aside}>
        <div className={styles.plots}>
          {plots.map((definition, place) => (
            <Plot key={definition.id} definition={definition} timed={place >= lowest} events={events} source={source} register={register} />
          ))}
        </div>
      </Panel>
    </div>
  );
}

/** One plot with its title, the values under the cursor or of now, and its chart. */
import { useMantineColorScheme } from "@mantine/core";
import { useCallback, useEffect, useMemo, useRef, type RefObject } from "react";
import { usePreferences } from "../../units/preferences";
import type { Series } from "../../source/series";
import { canvasColours } from "../../ui/theme/canvas";
import { CONTRAST, type Contrast } from "../../ui/theme/contrast";
import { useShared } from "../../ui/use-shared";
import { clock, fixed, shown, type Shown } from "../../units/units";
import { Chart, type ChartEvents } from "./chart";
import { comparedAt, useComparison, type Compared } from "./compared";
import type { Decorations } from "./decorations";
import type { FigureSource } from "./figure-of";
import type { Placed } from "./prediction";
import { unitOf, type Curve, type Known, type PlotDefinition } from "./plot-set";
import { ExportMenu } from "../../ui/export/ExportMenu";
import { write } from "./write";
import styles from "./Plot.module.css";
import type { Range } from "../../source/source";

/** What the panel tells each plot for every frame. */
export interface PlotFrame {
  /** What is drawn: a stretch as finely as the screen can show it, or the whole. */
  readonly series: Series;
  readonly whole: Series;
  readonly compared: Compared | null;
  readonly predicted: Placed | null;
  readonly range: Range;
  readonly known: Known;
  readonly decorations: Omit<Decorations, "levels" | "colours">;
}

/** Draws a frame; returns the time that the shared cursor is on. */
export type DrawPlot = (frame: PlotFrame) => number | null;

interface PlotProps {
  readonly definition: PlotDefinition;
  /** Names the times beneath. */
  readonly timed: boolean;
  readonly events: ChartEvents;
  /** What a figure says of where it comes from, and its file is named by. */
  readonly source: FigureSource;
  /** Takes the function that draws; returns what withdraws it. */
  readonly register: (draw: DrawPlot) => () => void;
}

function Sign({ curve }: { readonly curve: Curve }) {
  return (
    <svg width="16" height="8" aria-hidden="true">
      <line x1="0" y1="4" x2="16" y2="4" stroke={`var(--${curve.token})`} strokeWidth="2" strokeDasharray={curve.dash?.join(" ")} />
    </svg>
  );
}

type Values = RefObject<(HTMLElement | null)[]>;

/** The value of each curve, and that of the second recording beside it. */
function Readouts({ curves, values, others, comparing }: { readonly curves: readonly Curve[]; readonly values: Values; readonly others: Values; readonly comparing: boolean }) {
  return curves.map((curve, index) => (
    <span key={curve.quantity} className={styles.value} data-second={curve.label === "" || undefined}>
      {curve.label === "" ? "/" : <Sign curve={curve} />}
      {curve.label}{" "}
      <b
        ref={(element) => {
          values.current[index] = element;
        }}
      >
        —
      </b>
      {comparing && curve.label !== "" && (
        <i
          ref={(element) => {
            others.current[index] = element;
          }}
        >
          —
        </i>
      )}
    </span>
  ));
}

/** Milliseconds between two readings of what goes by: quicker ones nobody reads, and each lays out the page. */
const READING_PERIOD = 100;

/** Writes the values at a time into their elements; null: of now, which goes by. */
function useShowValues(definition: PlotDefinition, scale: Shown, values: Values, others: Values) {
  // A degree is some hundredth of a radian: as many digits, fewer of them decimals.
  const decimals = definition.as ? definition.decimals : Math.max(0, definition.decimals - Math.round(Math.log10(scale.factor)));
  const readAt = useRef(-Infinity);
  return useCallback(
    ({ series: drawn, whole, range, compared }: PlotFrame, asked: number | null) => {
      const now = performance.now();
      if (asked === null && now - readAt.current < READING_PERIOD) return;
      readAt.current = now;
      const time = asked ?? Infinity;
      const series = time >= range.from && time <= range.to ? drawn : whole;
      const row = Math.min(series.rowAt(time), series.length - 1);
      definition.curves.forEach(({ quantity }, index) => {
        write(values.current[index], fixed(series.at(quantity, row) * scale.factor, decimals));
        if (compared) write(others.current[index], fixed(comparedAt(compared, quantity, time) * scale.factor, decimals));
      });
    },
    [definition, scale, decimals, values, others],
  );
}

/** What the cursor reads, for who does not see it: "at 00:02.500: Left 0.139, Right 0.000 N". */
function readingOf({ curves }: PlotDefinition, values: readonly (HTMLElement | null)[], { unit }: Shown, time: number | null): string {
  if (time === null) return "";
  const words = curves.flatMap(({ label }, place) => (label === "" ? [] : [`${label} ${values[place]?.textContent ?? ""}`]));
  return `at ${clock(time)}: ${words.join(", ")} ${unit}`.trim();
}

/** For a press of an arrow, of the width; with Shift so many times as far. */
const STEP = 0.005;
const COARSE = 10;
/** A press of + shows so much of what was shown. */
const ZOOM = 0.5;

/** Reads and zooms the plot by keys; returns whether the key was one of them. */
function pressed(chart: Chart, { key, shiftKey }: Pick<KeyboardEvent, "key" | "shiftKey">, events: ChartEvents): boolean {
  const step = STEP * (shiftKey ? COARSE : 1);
  const about = (factor: number): void => {
    if (chart.cursorTime === null) chart.moveCursor(-0.5);
    events.wheel(chart.cursorTime ?? 0, factor);
  };
  const keys: Readonly<Record<string, () => void>> = {
    ArrowLeft: () => { chart.moveCursor(-step); },
    ArrowRight: () => { chart.moveCursor(step); },
    "+": () => { about(ZOOM); },
    "=": () => { about(ZOOM); },
    "-": () => { about(1 / ZOOM); },
    Home: events.follow,
    Enter: () => { if (chart.cursorTime !== null) events.moment(chart.cursorTime); },
  };
  const act = keys[key];
  act?.();
  return act !== undefined;
}

/** The keys of a plot that has the focus. @param tell is called once what the cursor reads has been drawn */
function readByKeys(element: HTMLElement, chart: Chart, events: ChartEvents, tell: () => void): () => void {
  const onKey = (event: KeyboardEvent): void => {
    if (event.ctrlKey || event.metaKey || event.altKey || !pressed(chart, event, events)) return;
    event.preventDefault();
    requestAnimationFrame(() => requestAnimationFrame(tell));
  };
  const onBlur = (): void => { chart.hideCursor(); };
  element.addEventListener("keydown", onKey);
  element.addEventListener("blur", onBlur);
  return () => {
    element.removeEventListener("keydown", onKey);
    element.removeEventListener("blur", onBlur);
  };
}

export function Plot({ definition, timed, events, source, register }: PlotProps) {
  const { angles } = usePreferences();
  const { colorScheme } = useMantineColorScheme();
  const [contrast] = useShared<Contrast>(CONTRAST);
  const place = useRef<HTMLDivElement>(null);
  const spoken = useRef<HTMLSpanElement>(null);
  const values = useRef<(HTMLElement | null)[]>([]);
  const others = useRef<(HTMLElement | null)[]>([]);
  const comparing = useComparison() !== null;
  const last = useRef<PlotFrame | null>(null);
  const scale = useMemo(() => definition.as ?? shown(unitOf(definition), angles), [definition, angles]);
  const showValues = useShowValues(definition, scale, values, others);

  useEffect(() => {
    const element = place.current;
    if (element === null) return;
    // Read after the theme has been set; the dependency below asks for it again.
    const colours = canvasColours();
    const chart = new Chart(definition, scale, colours, element, events, timed, comparing);
    const withdraw = register((frame) => {
      last.current = frame;
      const levels = definition.levels(frame.known).map(({ label, value }) => ({ label, value: value * scale.factor }));
      chart.draw(frame, { ...frame.decorations, levels, colours });
      const cursor = chart.cursorTime;
      showValues(frame, cursor ?? frame.decorations.moment);
      return cursor;
    });
    const observer = new ResizeObserver(() => {
      chart.resize(element);
    });
    observer.observe(element);
    const endKeys = readByKeys(element, chart, events, () => {
      if (spoken.current) spoken.current.textContent = readingOf(definition, values.current, scale, chart.cursorTime);
    });
    return () => {
      observer.disconnect();
      endKeys();
      withdraw();
      chart.destroy();
    };
  }, [definition, timed, scale, colorScheme, contrast, events, register, showValues, comparing]);

  return (
    <figure className={styles.plot} aria-label={`${definition.title} over mission time`}>
      <figcaption className={styles.caption}>
        <h3 title={definition.title}>{definition.title}</h3>
        <Readouts curves={definition.curves} values={values} others={others} comparing={comparing} />
        <span className={styles.unit}>{scale.unit}</span>
        <ExportMenu
          compact
          what={`the plot of ${definition.title.toLowerCase()}`}
          name={`${source.file}-${definition.id}`}
          draw={async () => (await import("./figure-of")).markupOf(definition, scale, last.current, source)}
          table={async () => (await import("./figure-of")).tableOf(definition, scale, last.current, source)}
        />
      </figcaption>
      <div ref={place} className={styles.chart} tabIndex={0} role="application" aria-label={`${definition.title}: arrows read, + and − zoom, Home shows the whole`} />
      <span ref={spoken} className="visually-hidden" role="status" />
    </figure>
  );
}

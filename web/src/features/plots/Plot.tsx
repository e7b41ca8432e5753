/** One plot with its title, the values under the cursor or of now, and its chart. */
import { useMantineColorScheme } from "@mantine/core";
import { useCallback, useEffect, useMemo, useRef, type RefObject } from "react";
import { usePreferences } from "../../units/preferences";
import type { Series } from "../../source/series";
import { canvasColours } from "../../ui/theme/canvas";
import { fixed, shown, type Shown } from "../../units/units";
import { Chart, type ChartEvents } from "./chart";
import { comparedAt, useComparison, type Compared } from "./compared";
import type { Decorations } from "./decorations";
import { plotFigure } from "./figure";
import { figureOf, type FigureSource } from "./figure-of";
import { unitOf, type Curve, type Known, type PlotDefinition } from "./plot-set";
import { ExportMenu } from "../../ui/export/ExportMenu";
import styles from "./Plot.module.css";
import type { Range } from "../../source/source";

/** What the panel tells each plot for every frame. */
export interface PlotFrame {
  /** What is drawn: a stretch as finely as the screen can show it, or the whole. */
  readonly series: Series;
  readonly whole: Series;
  readonly compared: Compared | null;
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

/** Writes the values at a time into their elements. */
function useShowValues(definition: PlotDefinition, scale: Shown, values: Values, others: Values) {
  // A degree is some hundredth of a radian: as many digits, fewer of them decimals.
  const decimals = definition.as ? definition.decimals : Math.max(0, definition.decimals - Math.round(Math.log10(scale.factor)));
  return useCallback(
    ({ series: drawn, whole, range, compared }: PlotFrame, time: number) => {
      const series = time >= range.from && time <= range.to ? drawn : whole;
      const row = Math.min(series.rowAt(time), series.length - 1);
      definition.curves.forEach(({ quantity }, index) => {
        const element = values.current[index];
        if (element) element.textContent = fixed(series.at(quantity, row) * scale.factor, decimals);
        const other = others.current[index];
        if (other && compared) other.textContent = fixed(comparedAt(compared, quantity, time) * scale.factor, decimals);
      });
    },
    [definition, scale, decimals, values, others],
  );
}

export function Plot({ definition, timed, events, source, register }: PlotProps) {
  const { angles } = usePreferences();
  const { colorScheme } = useMantineColorScheme();
  const place = useRef<HTMLDivElement>(null);
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
      chart.draw(frame.series, frame.range, { ...frame.decorations, levels, colours }, frame.compared);
      const cursor = chart.cursorTime;
      showValues(frame, cursor ?? frame.decorations.moment ?? Infinity);
      return cursor;
    });
    const observer = new ResizeObserver(() => {
      chart.resize(element);
    });
    observer.observe(element);
    return () => {
      observer.disconnect();
      withdraw();
      chart.destroy();
    };
  }, [definition, timed, scale, colorScheme, events, register, showValues, comparing]);

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
          draw={() => plotFigure(figureOf(definition, scale, last.current, source))}
        />
      </figcaption>
      <div ref={place} className={styles.chart} />
    </figure>
  );
}

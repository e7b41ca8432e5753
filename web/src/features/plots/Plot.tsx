/** One plot with its title, the values under the cursor or of now, and its chart. */
import { useMantineColorScheme } from "@mantine/core";
import { useCallback, useEffect, useMemo, useRef } from "react";
import { usePreferences } from "../../app/preferences";
import type { Series } from "../../store/series";
import { canvasColours } from "../../theme/canvas";
import { fixed, shown } from "../../units/units";
import { Chart, type ChartEvents } from "./chart";
import type { Decorations } from "./decorations";
import type { Known, PlotDefinition } from "./plot-set";
import styles from "./Plot.module.css";
import type { Range } from "./timeview";

/** What the panel tells each plot for every frame. */
export interface PlotFrame {
  readonly series: Series;
  readonly range: Range;
  readonly known: Known;
  readonly decorations: Omit<Decorations, "levels" | "colours">;
}

/** Draws a frame; returns the row of the series that the shared cursor is on. */
export type DrawPlot = (frame: PlotFrame) => number | null;

interface PlotProps {
  readonly definition: PlotDefinition;
  /** Names the times beneath. */
  readonly timed: boolean;
  readonly events: ChartEvents;
  /** Takes the function that draws; returns what withdraws it. */
  readonly register: (draw: DrawPlot) => () => void;
}

export function Plot({ definition, timed, events, register }: PlotProps) {
  const { angles } = usePreferences();
  const { colorScheme } = useMantineColorScheme();
  const place = useRef<HTMLDivElement>(null);
  const values = useRef<(HTMLElement | null)[]>([]);
  const scale = useMemo(() => shown(definition.unit, angles), [definition, angles]);

  // A degree is some hundredth of a radian: as many digits, fewer of them decimals.
  const decimals = Math.max(0, definition.decimals - Math.round(Math.log10(scale.factor)));

  const showValues = useCallback(
    (series: Series, row: number) => {
      definition.curves.forEach(({ quantity }, index) => {
        const value = series.at(quantity, row) * scale.factor;
        const element = values.current[index];
        if (element) element.textContent = fixed(value, decimals);
      });
    },
    [definition, scale, decimals],
  );

  useEffect(() => {
    const element = place.current;
    if (element === null) return;
    // Read after the theme has been set; the dependency below asks for it again.
    const colours = canvasColours();
    const chart = new Chart(definition, scale, colours, element, events, timed);
    const withdraw = register((frame) => {
      const levels = definition.levels(frame.known).map(({ label, value }) => ({ label, value: value * scale.factor }));
      chart.draw(frame.series, frame.range, { ...frame.decorations, levels, colours });
      const row = chart.cursorRow;
      const { moment } = frame.decorations;
      const shownRow = moment === null ? frame.series.length - 1 : Math.min(frame.series.rowAt(moment), frame.series.length - 1);
      showValues(frame.series, row ?? shownRow);
      return row;
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
  }, [definition, timed, scale, colorScheme, events, register, showValues]);

  return (
    <figure className={styles.plot} aria-label={`${definition.title} over mission time`}>
      <figcaption className={styles.caption}>
        <h3>{definition.title}</h3>
        {definition.curves.map((curve, index) => (
          <span key={curve.quantity} className={styles.value}>
            <svg width="16" height="8" aria-hidden="true">
              <line x1="0" y1="4" x2="16" y2="4" stroke={`var(--${curve.token})`} strokeWidth="2" strokeDasharray={curve.dash?.join(" ")} />
            </svg>
            {curve.label}{" "}
            <b
              ref={(element) => {
                values.current[index] = element;
              }}
            >
              —
            </b>
          </span>
        ))}
        <span className={styles.unit}>{scale.unit}</span>
      </figcaption>
      <div ref={place} className={styles.chart} />
    </figure>
  );
}

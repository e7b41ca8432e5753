/** How long heartbeats and commands took over the last minute: as a plot, and what it says in numbers. */
import { useMantineColorScheme } from "@mantine/core";
import { useEffect, useRef } from "react";
import { Panel } from "../../ui/Panel";
import type { LinkStatus } from "../../api/types";
import { canvasColours } from "../../ui/theme/canvas";
import { CURVES, LatencyChart } from "./latency-chart";
import styles from "./LinkPage.module.css";
import { milliseconds } from "./labels";

function Legend({ link }: { readonly link: LinkStatus }) {
  return (
    <ul className={styles.legend}>
      {CURVES.map(({ key, token, dash, label }) => (
        <li key={key}>
          <svg width="20" height="8" aria-hidden="true">
            <line x1="0" y1="4" x2="20" y2="4" stroke={`var(--${token})`} strokeWidth="2" strokeDasharray={dash?.join(" ")} />
          </svg>
          {label}
          <span>
            median <b>{milliseconds(link[key]?.p50 ?? null)}</b> ms, 99 % within <b>{milliseconds(link[key]?.p99 ?? null)}</b> ms
          </span>
        </li>
      ))}
    </ul>
  );
}

export function LatencyPlot({ link, shown }: { readonly link: LinkStatus; readonly shown: boolean }) {
  const { colorScheme } = useMantineColorScheme();
  const place = useRef<HTMLDivElement>(null);
  const chart = useRef<LatencyChart | null>(null);

  useEffect(() => {
    const element = place.current;
    if (element === null || !shown) return undefined;
    const drawn = new LatencyChart(element, canvasColours());
    chart.current = drawn;
    const observer = new ResizeObserver(() => {
      drawn.resize(element);
    });
    observer.observe(element);
    return () => {
      observer.disconnect();
      chart.current = null;
      drawn.destroy();
    };
  }, [colorScheme, shown]);

  useEffect(() => {
    chart.current?.draw(link);
  }, [link, colorScheme, shown]);

  return (
    <div className={styles.latency}>
      <Panel title="Latency" grow dated="service" aside={<span className={styles.unit}>ms, over the last minute</span>}>
        <Legend link={link} />
        <div
          ref={place}
          className={styles.chart}
          role="img"
          aria-label="Round trip of heartbeats, worst of each fifth of a second, and 99 % quantile of the age of commands at the robot, over the last minute"
        />
      </Panel>
    </div>
  );
}

/** The plot of several runs on the page: read by pointer or keys, zoomed, exported. */
import { useElementSize } from "@mantine/hooks";
import { useState, type KeyboardEvent, type PointerEvent } from "react";
import type { Extent } from "./curves";
import { nearestRow } from "./curves";
import { OverlayPicture, placesOf, scalesOf, type DrawnCurve, type Ink } from "./OverlayPicture";
import styles from "./OverlayPage.module.css";

export const PAGE_INK: Ink = { ground: "var(--panel)", text: "var(--dim)", grid: "var(--grid)", axis: "var(--line-strong)" };

/** Of the width, for a press of an arrow. */
const STEP = 0.01;
const LEAST = { width: 320, height: 240 };
/** Pixels that a drag takes to choose a stretch. */
const DRAG = 5;

export interface Cursor {
  readonly x: number;
  /** Null where x is time: every curve is read at it. */
  readonly y: number | null;
}

interface PlotProps {
  readonly curves: readonly DrawnCurve[];
  /** Of all that is drawn. */
  readonly whole: Extent;
  readonly timed: boolean;
  readonly xLabel: string;
  readonly yLabel: string;
  readonly cursor: Cursor | null;
  readonly onCursor: (cursor: Cursor | null) => void;
  readonly zoom: readonly [number, number] | null;
  readonly onZoom: (zoom: readonly [number, number] | null) => void;
}

/** What keys do: arrows move the cursor, + and - zoom about it, Home shows the whole. */
function keyed(key: string, { cursor, zoom, whole, timed }: Pick<PlotProps, "cursor" | "zoom" | "whole" | "timed">, coarse: boolean): { cursor?: Cursor; zoom?: readonly [number, number] | null } | null {
  const [low, high] = zoom ?? whole.x;
  const now = cursor ?? { x: (low + high) / 2, y: timed ? null : (whole.y[0] + whole.y[1]) / 2 };
  const step = STEP * (coarse ? 10 : 1);
  const within = (value: number, [least, most]: readonly [number, number]): number => Math.min(most, Math.max(least, value));
  const across = (sign: number) => ({ cursor: { ...now, x: within(now.x + sign * step * (high - low), [low, high]) } });
  const up = (sign: number) => (now.y === null ? null : { cursor: { ...now, y: within(now.y + sign * step * (whole.y[1] - whole.y[0]), whole.y) } });
  const about = (factor: number) => ({ cursor: now, zoom: [Math.max(whole.x[0], now.x - (now.x - low) * factor), Math.min(whole.x[1], now.x + (high - now.x) * factor)] as const });
  if (key === "ArrowLeft") return across(-1);
  if (key === "ArrowRight") return across(1);
  if (key === "ArrowUp") return up(1);
  if (key === "ArrowDown") return up(-1);
  if (key === "+" || key === "=") return about(0.5);
  if (key === "-") return about(2);
  return key === "Home" ? { zoom: null } : null;
}

/** A drag of the pointer chooses a stretch. */
function useChoosing(at: (event: PointerEvent<HTMLElement>) => number, width: number, onZoom: PlotProps["onZoom"]) {
  const [begun, setBegun] = useState<number | null>(null);
  const [now, setNow] = useState<number | null>(null);
  const done = (): void => {
    setBegun(null);
    setNow(null);
  };
  return {
    choosing: begun !== null && now !== null && Math.abs(now - begun) > width * DRAG ? ([begun, now] as const) : null,
    down: (event: PointerEvent<HTMLElement>) => {
      if (event.button !== 0 || event.pointerType === "touch") return;
      setBegun(at(event));
    },
    move: (event: PointerEvent<HTMLElement>) => { if (begun !== null) setNow(at(event)); },
    up: () => {
      if (begun !== null && now !== null && Math.abs(now - begun) > width * DRAG) onZoom([Math.min(begun, now), Math.max(begun, now)]);
      done();
    },
    cancel: done,
  };
}

export function OverlayPlot(props: PlotProps) {
  const { curves, whole, timed, cursor, onCursor, zoom, onZoom } = props;
  const { ref, width, height } = useElementSize<HTMLDivElement>();
  const size = { width: Math.max(LEAST.width, Math.floor(width)), height: Math.max(LEAST.height, Math.floor(height)) };
  const extent: Extent = { x: zoom ?? whole.x, y: whole.y };
  const { x, y } = scalesOf({ extent }, placesOf({ size, curves }));
  const placeOf = (event: PointerEvent<HTMLElement>): Cursor => {
    const box = event.currentTarget.getBoundingClientRect();
    return { x: x.invert(event.clientX - box.left), y: timed ? null : y.invert(event.clientY - box.top) };
  };
  const pixel = (extent.x[1] - extent.x[0]) / size.width;
  const drag = useChoosing((event) => placeOf(event).x, pixel, onZoom);
  const scale = { x: 1 / pixel, y: size.height / (extent.y[1] - extent.y[0]) };
  const read = cursor === null ? [] : curves.flatMap((curve) => {
    const row = nearestRow(curve, cursor.x, cursor.y, scale);
    return row < 0 ? [] : [{ x: curve.xs[row] ?? 0, y: curve.ys[row] ?? 0, colour: curve.colour }];
  });
  const onKeyDown = (event: KeyboardEvent): void => {
    const change = keyed(event.key, props, event.shiftKey);
    if (change === null || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (change.cursor !== undefined) onCursor(change.cursor);
    if (change.zoom !== undefined) onZoom(change.zoom);
  };
  return (
    <div
      ref={ref}
      className={styles.plot}
      role="application"
      aria-label={`${props.yLabel} over ${props.xLabel}`}
      aria-describedby="overlay-values"
      tabIndex={0}
      onKeyDown={onKeyDown}
      onPointerMove={(event) => { onCursor(placeOf(event)); drag.move(event); }}
      onPointerDown={drag.down}
      onPointerUp={drag.up}
      onPointerLeave={() => { onCursor(null); drag.cancel(); }}
      onDoubleClick={() => { onZoom(null); }}
    >
      <OverlayPicture curves={curves} extent={extent} size={size} xLabel={props.xLabel} yLabel={props.yLabel} ink={PAGE_INK} read={read} choosing={drag.choosing} />
    </div>
  );
}

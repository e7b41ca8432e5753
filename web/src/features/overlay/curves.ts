/** Several runs as curves of one plot: pure functions from what is stored of them to points. */
import type { History, Run } from "../../api/types";
import { columnsOfTable } from "../../source/columns";
import { phaseOf } from "../../source/phases";
import { TIME, type OverlayAlignment } from "../library/overlay-address";
import type { Expression } from "./expression";

export interface OverlayCurve {
  readonly run: string;
  readonly xs: Float64Array;
  readonly ys: Float64Array;
}

export interface Extent {
  readonly x: readonly [number, number];
  readonly y: readonly [number, number];
}

/** Columns that every curve needs: where it begins to move, and when. */
export const ALWAYS = ["mission.time", "mission.phase"] as const;

/** The mission time of what is laid over one another, seconds; null where it never came. */
export function eventTime(align: OverlayAlignment, run: Pick<Run, "outcome">, history: History): number | null {
  if (align === "clock") return 0;
  if (align === "touch") return run.outcome?.contacts[0]?.start ?? null;
  if (align === "closure") return run.outcome?.closed_at ?? null;
  for (const column of columnsOfTable(history)) {
    if (Number.isFinite(column("mission.phase")) && phaseOf(column("mission.phase")) !== "idle") return column("mission.time");
  }
  return null;
}

export const ALIGNMENT_WORDS: Readonly<Record<OverlayAlignment, string>> = {
  motion: "first motion",
  touch: "first touch",
  closure: "closure",
  clock: "mission time 0",
};

/** Why a run has no curve; null if it has one. */
export function missingWords(align: OverlayAlignment, x: string, run: Pick<Run, "outcome">, history: History): string | null {
  return x.trim() === TIME && eventTime(align, run, history) === null ? `no ${ALIGNMENT_WORDS[align]}` : null;
}

/** Seconds before the first motion that are shown: a run may have stood idle for minutes. */
const LEAD = 1;

/** NaN stands where nothing was recorded. */
export function curveOf(run: Pick<Run, "id" | "outcome">, history: History, x: Expression, y: Expression, timed: boolean, align: OverlayAlignment): OverlayCurve {
  const rows = columnsOfTable(history);
  const begin = (eventTime("motion", run, history) ?? 0) - LEAD;
  const shown = align === "clock" ? rows : rows.filter((column) => !(column("mission.time") < begin));
  const shift = timed ? (eventTime(align, run, history) ?? Number.NaN) : 0;
  return { run: run.id, xs: Float64Array.from(shown, (column) => x.of(column) - shift), ys: Float64Array.from(shown, y.of) };
}

/** Of all that is drawn, with a little room above and below; null of nothing. */
export function extentOf(curves: readonly OverlayCurve[]): Extent | null {
  const x: [number, number] = [Infinity, -Infinity];
  const y: [number, number] = [Infinity, -Infinity];
  for (const { xs, ys } of curves) {
    for (let row = 0; row < xs.length; row += 1) {
      const [across, up] = [xs[row] ?? Number.NaN, ys[row] ?? Number.NaN];
      if (!Number.isFinite(across) || !Number.isFinite(up)) continue;
      x[0] = Math.min(x[0], across);
      x[1] = Math.max(x[1], across);
      y[0] = Math.min(y[0], up);
      y[1] = Math.max(y[1], up);
    }
  }
  if (x[0] > x[1]) return null;
  return { x: widened(x, 0), y: widened(y, 0.05) };
}

/** A range of nothing has a width, too. */
function widened([low, high]: readonly [number, number], share: number): readonly [number, number] {
  const width = high - low || Math.max(1e-6, Math.abs(high) * 0.1);
  return high === low ? [low - width / 2, high + width / 2] : [low - share * width, high + share * width];
}

/** The row that stands nearest to that place, by the distances that a pixel has; -1 of none. */
export function nearestRow({ xs, ys }: OverlayCurve, x: number, y: number | null, scale: { readonly x: number; readonly y: number }): number {
  let [best, row] = [Infinity, -1];
  for (let at = 0; at < xs.length; at += 1) {
    const across = ((xs[at] ?? Number.NaN) - x) * scale.x;
    const up = y === null ? 0 : ((ys[at] ?? Number.NaN) - y) * scale.y;
    const far = across * across + up * up;
    if (far < best && Number.isFinite(ys[at])) [best, row] = [far, at];
  }
  return row;
}

/** Pixels: what lies closer to the point before cannot be seen. */
const VISIBLE = 0.6;

/** The path of a curve, of which only the points remain that can be told apart; it is broken where nothing was recorded. */
export function pathOf({ xs, ys }: OverlayCurve, x: (value: number) => number, y: (value: number) => number): string {
  let [path, pen] = ["", false];
  let [lastX, lastY] = [Number.NaN, Number.NaN];
  for (let row = 0; row < xs.length; row += 1) {
    const [across, up] = [x(xs[row] ?? Number.NaN), y(ys[row] ?? Number.NaN)];
    if (!Number.isFinite(across) || !Number.isFinite(up)) {
      pen = false;
      continue;
    }
    if (pen && Math.abs(across - lastX) < VISIBLE && Math.abs(up - lastY) < VISIBLE) continue;
    path += `${pen ? "L" : "M"}${across.toFixed(1)} ${up.toFixed(1)}`;
    [lastX, lastY, pen] = [across, up, true];
  }
  return path;
}

/** The stretch of time that all plots show: it follows the mission, or stands where a person has zoomed. */
import type { Range } from "../../source/source";
import { clock, decimalsOf, fixed } from "../../units/units";

/** The last seconds that are shown; 0 is the whole mission, but for an idle time before it. */
export type Window = 0 | 10 | 30;

const SHORTEST = 0.02;
const LEAST_WHOLE = 5;
/** Seconds shown before the first motion. */
const LEAD = 1;

export interface TimeView {
  readonly window: Window;
  /** Set while a person looks at a chosen stretch. */
  readonly zoomed: Range | null;
  /** The mission goes on, the plots do not. */
  readonly pausedAt: number | null;
}

export const FOLLOW: TimeView = { window: 30, zoomed: null, pausedAt: null };

/** What is predicted has at most so much of a window that follows the mission. */
const AHEAD_SHARE = 0.5;

/** What is shown when the mission has come to `now`, having left idle at `firstMotion`, with so many seconds predicted ahead of it. */
export function rangeOf(view: TimeView, now: number, firstMotion: number, ahead = 0): Range {
  if (view.zoomed) return view.zoomed;
  const room = view.window === 0 ? ahead : Math.min(ahead, AHEAD_SHARE * view.window);
  const end = (view.pausedAt ?? now) + Math.max(0, room);
  const begin = Math.max(0, firstMotion - LEAD);
  if (view.window === 0) return { from: begin, to: Math.max(end, begin + LEAST_WHOLE) };
  return { from: Math.max(0, end - view.window), to: Math.max(end, view.window) };
}

/** Seconds from which on times are read in minutes. */
const MINUTES = 120;

/** The times of an axis: seconds, and minutes with seconds from two minutes on; each with its unit once. */
export function timeLabels(times: readonly number[]): string[] {
  const decimals = decimalsOf(times);
  if ((times.at(-1) ?? 0) <= MINUTES) return times.map((time, place) => `${fixed(time, decimals)}${place === times.length - 1 ? " s" : ""}`);
  return times.map((time) => clock(time, decimals));
}

/** Zooms by a factor about a moment, never beyond the beginning. */
export function zoomedAbout(range: Range, moment: number, factor: number): Range {
  const width = Math.max(SHORTEST, (range.to - range.from) * factor);
  const share = (moment - range.from) / (range.to - range.from);
  const from = Math.max(0, moment - share * width);
  return { from, to: from + width };
}

/** A stretch that was drawn with the mouse, at least as long as can be shown. */
export function chosen(one: number, other: number): Range {
  const from = Math.max(0, Math.min(one, other));
  return { from, to: Math.max(Math.max(one, other), from + SHORTEST) };
}

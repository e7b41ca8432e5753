/** The moment of a stored run, and the stretch of its plots, as the address keeps them: `#/runs/ID?t=12.3&from=10&to=15`. */
import { useEffect } from "react";
import type { Playback } from "../source/playback";
import type { Range } from "../source/source";
import { subscribe } from "./route";

export interface Moment {
  /** Mission time, seconds; null where the address says nothing of it. */
  readonly time: number | null;
  /** What the plots are zoomed to; null for the whole. */
  readonly range: Range | null;
}

/** Decimals of a second: those of a tick. */
const DECIMALS = 3;

function secondsOf(text: string | null): number | null {
  const value = text === null || text.trim() === "" ? Number.NaN : Number(text);
  return Number.isFinite(value) && value >= 0 ? value : null;
}

/** What an address says; what cannot be is left out. */
export function momentOf(hash: string): Moment {
  const asked = new URLSearchParams(hash.split("?")[1] ?? "");
  const [from, to] = [secondsOf(asked.get("from")), secondsOf(asked.get("to"))];
  return { time: secondsOf(asked.get("t")), range: from !== null && to !== null && to > from ? { from, to } : null };
}

const written = (seconds: number): string => String(Number(seconds.toFixed(DECIMALS)));

/** The same address with that of it; the rest of the address stays. */
export function withMoment(hash: string, change: Partial<Moment>): string {
  const [path = "", query = ""] = hash.split("?");
  const asked = new URLSearchParams(query);
  const next = { ...momentOf(hash), ...change };
  for (const name of ["t", "from", "to"]) asked.delete(name);
  if (next.time !== null) asked.set("t", written(next.time));
  if (next.range !== null) {
    asked.set("from", written(next.range.from));
    asked.set("to", written(next.range.to));
  }
  const words = asked.toString();
  return words === "" ? path : `${path}?${words}`;
}

/** Keeps it in the address, without a step in the browser's history; nothing is told of it. */
export function keepMoment(change: Partial<Moment>): void {
  const hash = withMoment(location.hash, change);
  if (hash !== location.hash) history.replaceState(history.state, "", hash);
}

/** Milliseconds that a moment has to stand still before the address follows. */
const STILL = 250;

/** The playback goes where the address says, and the address says where the playback stands. */
export function useMomentAddress(playback: Playback | null): void {
  useEffect(() => {
    if (playback === null) return undefined;
    const goThere = (): void => {
      const { time } = momentOf(location.hash);
      if (time !== null && Math.abs(time - playback.read().time) > playback.period / 2) playback.seek(time);
    };
    let timer: ReturnType<typeof setTimeout> | undefined;
    const follow = (): void => {
      clearTimeout(timer);
      timer = setTimeout(() => {
        const { time, playing, end } = playback.read();
        // A run that nobody has moved in keeps its short address.
        if (!playing && end > 0 && (momentOf(location.hash).time !== null || Math.abs(time - playback.start) > playback.period / 2)) keepMoment({ time });
      }, STILL);
    };
    goThere();
    const [withdraw, end] = [playback.subscribe(follow), subscribe(goThere)];
    return () => {
      clearTimeout(timer);
      withdraw();
      end();
    };
  }, [playback]);
}

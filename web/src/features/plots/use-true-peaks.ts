/** A mission that flies is drawn from what the browser was sent, which leaves ticks out; the service's history does not. */
import { useEffect, type RefObject } from "react";
import { Refusal } from "../../api/refusal";
import { readHistory } from "../../api/service";
import { useStore } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { samplesOfTable } from "../../source/quantities";
import { usePageVisible } from "../../ui/use-page-visible";

/** Milliseconds between two looks. */
const PERIOD = 5000;
/** Rows from which on the whole is asked for anew: its history is shorter and has every extreme. */
const MANY = 10_000;

/** @returns the last tick whose extremes are known now. */
async function takeExtremes(store: MissionStore, known: number): Promise<number> {
  const since = store.series.length > MANY || known > store.series.lastTick ? -1 : known;
  const history = await readHistory(since);
  // A reset meanwhile: this is the history of another mission than the one that is shown.
  if (store.read().snapshot?.run_id !== history.run_id) return -1;
  const samples = samplesOfTable(history);
  store.history(samples);
  return samples.at(-1)?.tick ?? known;
}

/** Puts the extremes of every piece of time in place of the samples, as long as somebody can see the plots. */
export function useTruePeaks(wanted: boolean, place: RefObject<HTMLElement | null>): void {
  const store = useStore();
  const visible = usePageVisible();
  useEffect(() => {
    if (!wanted || !visible) return undefined;
    let known = -1;
    let busy = false;
    const look = (): void => {
      if (busy || store.series.length === 0 || place.current?.checkVisibility() !== true) return;
      busy = true;
      takeExtremes(store, known)
        .then(
          (tick) => { known = tick; },
          (cause: unknown) => { if (!(cause instanceof Refusal)) throw cause; },
        )
        .finally(() => { busy = false; });
    };
    const timer = setInterval(look, PERIOD);
    return () => {
      clearInterval(timer);
    };
  }, [wanted, visible, store, place]);
}

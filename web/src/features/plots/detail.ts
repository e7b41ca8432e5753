/** A stretch of a recorded run as finely as the screen can show it, asked for when somebody looks closely. */
import { useEffect, useState } from "react";
import { Refusal } from "../../api/refusal";
import { readTicks } from "../../api/service";
import { samplesOfTable } from "../../source/quantities";
import { Series } from "../../source/series";
import type { Range } from "./timeview";

/** Rows for a stretch: two for each column of pixels of the widest screens. */
const POINTS = 4000;
/** Milliseconds that a stretch has to stand still before it is asked for. */
const STILL = 200;
/** Asked for on either side, so that a small step needs no new question. */
const MARGIN = 0.25;

export interface Detail {
  readonly series: Series;
  readonly range: Range;
}

/** The detail if it holds all of that stretch, else what there is of the whole. */
export const seriesFor = (detail: Detail | null, range: Range, whole: Series): Series =>
  detail !== null && detail.range.from <= range.from && detail.range.to >= range.to ? detail.series : whole;

async function readDetail(run: string, { from, to }: Range): Promise<Detail> {
  const margin = MARGIN * (to - from);
  const range = { from: Math.max(0, from - margin), to: to + margin };
  const series = new Series(POINTS + POINTS / 4);
  series.merge(samplesOfTable(await readTicks(run, POINTS, range)));
  return { series, range };
}

/** Of that run (null: of none) for that stretch (null: the whole is enough), in seconds of its own clock. */
export function useDetail(run: string | null, range: Range | null): Detail | null {
  const [detail, setDetail] = useState<(Detail & { readonly run: string }) | null>(null);
  const [from, to] = [range?.from ?? null, range?.to ?? null];
  useEffect(() => {
    if (run === null || from === null || to === null) return undefined;
    let wanted = true;
    const timer = setTimeout(() => {
      readDetail(run, { from, to }).then(
        (found) => {
          if (wanted) setDetail({ ...found, run });
        },
        (cause: unknown) => {
          // Nothing recorded there, or no answer: the whole of the run is shown as it is.
          if (!(cause instanceof Refusal)) throw cause;
        },
      );
    }, STILL);
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [run, from, to]);
  return detail?.run === run ? detail : null;
}

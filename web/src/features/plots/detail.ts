/** A stretch as finely as the screen can show it, asked of the source when somebody looks closely. */
import { useDebouncedValue } from "@mantine/hooks";
import { keepPreviousData, skipToken, useQuery } from "@tanstack/react-query";
import { useId } from "react";
import { POINTS } from "../../source/read-finely";
import { Series } from "../../source/series";
import type { Range, Source } from "../../source/source";
import { useViewOf } from "../../store/context";
import type { MissionStore } from "../../store/mission";

/** Milliseconds that a stretch has to stand still before it is asked for. */
const STILL = 200;
/** Asked for on either side, so that a small step needs no new question. */
const MARGIN = 0.25;
/** Milliseconds until a stretch that is not known yet is asked for again. */
const RETRY_PERIOD = 1000;
/** Milliseconds for which a stretch is kept that nobody looks at any more. */
const KEPT = 60_000;

export interface Detail {
  readonly series: Series;
  readonly range: Range;
}

/** The detail if it holds all of that stretch, else what there is of the whole. */
export const seriesFor = (detail: Detail | null, range: Range, whole: Series): Series =>
  detail !== null && detail.range.from <= range.from && detail.range.to >= range.to ? detail.series : whole;

async function readDetail(source: Source, { from, to }: Range): Promise<Detail | null> {
  const margin = MARGIN * (to - from);
  const range = { from: Math.max(0, from - margin), to: to + margin };
  const samples = await source.readRange(range);
  if (samples === null) return null;
  const series = new Series(POINTS + POINTS / 4);
  series.merge(samples);
  return { series, range };
}

/** Of what that store shows (null: of nothing) for that stretch (null: the whole is enough), in its own mission time. */
export function useDetail(store: MissionStore | null, range: Range | null): Detail | null {
  const hook = useId();
  const run = useViewOf(store, (view) => view.run?.id ?? null);
  const [asked] = useDebouncedValue(run === null || range === null ? null : `${run} ${range.from} ${range.to}`, STILL);
  const known = useQuery({
    queryKey: ["detail", hook, asked],
    queryFn:
      store === null || asked === null
        ? skipToken
        : async () => {
            const [of = "", from, to] = asked.split(" ");
            return { of, detail: await readDetail(store.source, { from: Number(from), to: Number(to) }) };
          },
    staleTime: Infinity,
    gcTime: KEPT,
    structuralSharing: false,
    placeholderData: keepPreviousData,
    refetchInterval: ({ state }) => (state.data?.detail === null ? RETRY_PERIOD : false),
  }).data;
  // Nothing recorded there, or no answer: the whole is shown as it is.
  return asked !== null && known?.of === run ? known.detail : null;
}

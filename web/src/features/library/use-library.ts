/** The runs that fit a query, and what is stored of one of them. */
import { keepPreviousData, skipToken, useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, useMemo } from "react";
import { refusalIn } from "../../api/query-client";
import type { Refusal } from "../../api/refusal";
import { listRuns, readRun, type Tagged } from "../../api/service";
import type { Run, RunPage, RunSummary } from "../../api/types";
import { isUnderWay, RecordedSource, type RecordedSourceOptions } from "../../source/recorded-source";
import { MissionStore } from "../../store/mission";
import { requestOf, type LibraryQuery } from "./query";

/** Milliseconds between two looks: while a run of the page flies, and else. */
const LIVELY_PERIOD = 2000;
const CALM_PERIOD = 10_000;
const RUN_PERIOD = 1000;

export interface Library {
  readonly runs: readonly RunSummary[];
  readonly total: number;
  readonly unreadable: RunPage["unreadable"];
  readonly refusal: Refusal | null;
  readonly read: boolean;
}

const EMPTY = { runs: [], total: 0, unreadable: [] };

/** A page of the library, looked at again while it is shown: what has not changed is not sent again. */
export function useLibrary(shown: boolean, query: LibraryQuery): Library {
  const client = useQueryClient();
  const queryKey = ["runs", requestOf(query)];
  const { data, error } = useQuery({
    queryKey,
    queryFn: async () => {
      const known = client.getQueryData<Tagged<RunPage>>(queryKey);
      const found = await listRuns(requestOf(query), known?.tag ?? null);
      return found ?? known ?? null;
    },
    enabled: shown,
    placeholderData: keepPreviousData,
    refetchInterval: ({ state }) => (state.data?.body.runs.some(isUnderWay) ? LIVELY_PERIOD : CALM_PERIOD),
  });
  return { ...(data?.body ?? EMPTY), refusal: refusalIn(error), read: data !== undefined };
}

/** One run, read again while it flies; null for none, or while it is read. */
export function useRun(id: string): { readonly run: Run | null; readonly refusal: Refusal | null } {
  const { data, error } = useQuery({
    queryKey: ["run", id],
    queryFn: id === "" ? skipToken : () => readRun(id),
    refetchInterval: ({ state }) => (state.data !== undefined && isUnderWay(state.data) ? RUN_PERIOD : false),
  });
  return { run: data ?? null, refusal: refusalIn(error) };
}

/** Everything that shows runs reads them again: somebody changed one. */
export function useReadAgain(): () => Promise<void> {
  const client = useQueryClient();
  return async () => {
    await Promise.all([client.invalidateQueries({ queryKey: ["runs"] }), client.invalidateQueries({ queryKey: ["run"] })]);
  };
}

/** What is stored of a run, as a mission that panels show; null for none, or while nothing has been recorded. */
export function useStored(run: Run | null, options?: Partial<RecordedSourceOptions>): MissionStore | null {
  const id = run !== null && run.ticks > 0 ? run.id : null;
  const store = useMemo(() => (id === null ? null : new MissionStore(new RecordedSource(id, options))), [id, options]);
  useEffect(() => store?.open(), [store]);
  return store;
}

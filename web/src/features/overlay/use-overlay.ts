/** What is stored of several runs, in the columns that a plot needs. */
import { keepPreviousData, skipToken, useQueries, useQuery } from "@tanstack/react-query";
import { readColumns, readRun, readSamples } from "../../api/service";
import type { History, HistoryColumn, Run } from "../../api/types";
import { ALWAYS } from "./curves";

export interface OverlaidRun {
  readonly id: string;
  /** Null while it is read. */
  readonly run: Run | null;
  readonly history: History | null;
  /** Why one of them cannot be had. */
  readonly trouble: string | null;
}

/** The columns that may be named, the same for every run of this service; none while they are read. */
export function useColumns(run: string | undefined): readonly HistoryColumn[] {
  const { data } = useQuery({
    queryKey: ["columns"],
    queryFn: run === undefined ? skipToken : () => readColumns(run),
    staleTime: Infinity,
  });
  return data ?? [];
}

export function useOverlaid(ids: readonly string[], columns: readonly string[]): readonly OverlaidRun[] {
  const asked = [...new Set([...ALWAYS, ...columns])].sort();
  const runs = useQueries({ queries: ids.map((id) => ({ queryKey: ["run", id], queryFn: () => readRun(id), staleTime: 60_000 })) });
  const histories = useQueries({
    queries: ids.map((id) => ({
      queryKey: ["samples", id, asked.join(",")],
      queryFn: columns.length === 0 ? skipToken : () => readSamples(id, asked),
      placeholderData: keepPreviousData,
      // A megabyte or more each: not compared with what was there, and not kept for long.
      structuralSharing: false,
      staleTime: 60_000,
      gcTime: 60_000,
    })),
  });
  return ids.map((id, place) => ({
    id,
    run: runs[place]?.data ?? null,
    history: histories[place]?.data ?? null,
    trouble: (runs[place]?.error ?? histories[place]?.error)?.message ?? null,
  }));
}

/** A study and its rows, asked for again while it flies. */
import { skipToken, useQuery, useQueryClient } from "@tanstack/react-query";
import { refusalIn } from "../../api/query-client";
import type { Refusal } from "../../api/refusal";
import { listStudies, readRows, readStudy } from "../../api/service";
import type { StudyDetail, StudyPage, StudyRow, StudySummary } from "../../api/types";

/** Milliseconds between two looks: a map that fills should be seen to fill. */
const LIVE_PERIOD = 700;
const LIST_PERIOD = 3000;

export type Rows = ReadonlyMap<number, StudyRow>;

export interface StudyView {
  readonly study: StudyDetail | null;
  /** By cell. */
  readonly rows: Rows;
  readonly refusal: Refusal | null;
}

const NO_ROWS: Rows = new Map();

export const isUnderWay = (study: StudySummary): boolean => study.status === "queued" || study.status === "running";

interface Known {
  readonly study: StudyDetail;
  readonly rows: Rows;
  /** The place of the last row. */
  readonly last: number;
}

/** The study with all rows that came after those that are known. @throws Refusal */
async function readFurther(id: string, known: Known | undefined): Promise<Known> {
  const study = await readStudy(id);
  const rows = new Map(known?.rows);
  let last = known?.last ?? 0;
  for (;;) {
    const page = await readRows(id, last);
    for (const row of page.rows) rows.set(Number(row["cell"]), row);
    if (page.rows.length === 0) return { study, rows, last };
    last = page.last;
  }
}

/** Of none with an empty identifier. */
export function useStudy(id: string): StudyView {
  const client = useQueryClient();
  const queryKey = ["study", id];
  const { data, error } = useQuery({
    queryKey,
    queryFn: id === "" ? skipToken : () => readFurther(id, client.getQueryData<Known>(queryKey)),
    structuralSharing: false,
    refetchInterval: ({ state }) => {
      const refusal = refusalIn(state.error);
      if (refusal !== null) return refusal.decided ? false : LIST_PERIOD;
      return state.data !== undefined && isUnderWay(state.data.study) ? LIVE_PERIOD : false;
    },
  });
  return { study: data?.study ?? null, rows: data?.rows ?? NO_ROWS, refusal: refusalIn(error) };
}

export interface StudyList {
  readonly studies: readonly StudySummary[];
  readonly unreadable: StudyPage["unreadable"];
  readonly refusal: Refusal | null;
  readonly read: boolean;
}

/** The studies of the service, newest first, while the page is shown. */
export function useStudies(shown: boolean): StudyList {
  const { data, error } = useQuery({ queryKey: ["studies"], queryFn: listStudies, enabled: shown, refetchInterval: LIST_PERIOD, refetchIntervalInBackground: true });
  return { studies: data?.studies ?? [], unreadable: data?.unreadable ?? [], refusal: refusalIn(error), read: data !== undefined };
}

/** Everything that shows studies reads them again: somebody changed one. */
export function useReadAgain(): () => Promise<void> {
  const client = useQueryClient();
  return async () => {
    await Promise.all([client.invalidateQueries({ queryKey: ["studies"] }), client.invalidateQueries({ queryKey: ["study"] })]);
  };
}

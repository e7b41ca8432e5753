/** A study and its rows, asked for again while it flies. */
import { useEffect, useState } from "react";
import { Refusal } from "../../api/refusal";
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

const NOTHING: StudyView = { study: null, rows: new Map(), refusal: null };

export const isUnderWay = (study: StudySummary): boolean => study.status === "queued" || study.status === "running";

/** Calls `look` at once and then again and again, one call at a time, as long as it says so; returns how to end it. */
function lookAgain(look: () => Promise<number | null>): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let ended = false;
  const next = async (): Promise<void> => {
    const pause = await look();
    if (!ended && pause !== null) timer = setTimeout(() => void next(), pause);
  };
  void next();
  return () => {
    ended = true;
    clearTimeout(timer);
  };
}

/** All rows that came after `last`, page by page, put into `rows`; the place of the last one. */
async function takeRows(id: string, rows: Map<number, StudyRow>, last: number): Promise<number> {
  for (;;) {
    const page = await readRows(id, last);
    for (const row of page.rows) rows.set(Number(row["cell"]), row);
    if (page.rows.length === 0) return last;
    last = page.last;
  }
}

/** `edition` changes when a person did something to the study, so that it is read again at once. */
export function useStudy(id: string, edition: number): StudyView {
  const [view, setView] = useState<StudyView>(NOTHING);
  useEffect(() => {
    if (id === "") {
      setView(NOTHING);
      return undefined;
    }
    let wanted = true;
    let last = 0;
    const rows = new Map<number, StudyRow>();
    const end = lookAgain(async () => {
      try {
        const study = await readStudy(id);
        last = await takeRows(id, rows, last);
        if (wanted) setView({ study, rows: new Map(rows), refusal: null });
        return isUnderWay(study) ? LIVE_PERIOD : null;
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        if (wanted) setView((before) => ({ ...before, refusal: cause }));
        return cause.decided ? null : LIST_PERIOD;
      }
    });
    return () => {
      wanted = false;
      end();
    };
  }, [id, edition]);
  return view;
}

export interface StudyList {
  readonly studies: readonly StudySummary[];
  readonly unreadable: StudyPage["unreadable"];
  readonly refusal: Refusal | null;
  readonly read: boolean;
}

/** The studies of the service, newest first, while the page is shown. */
export function useStudies(shown: boolean, edition: number): StudyList {
  const [list, setList] = useState<StudyList>({ studies: [], unreadable: [], refusal: null, read: false });
  useEffect(() => {
    if (!shown) return undefined;
    return lookAgain(async () => {
      try {
        const page = await listStudies();
        setList({ studies: page.studies, unreadable: page.unreadable, refusal: null, read: true });
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        setList((before) => ({ ...before, refusal: cause }));
      }
      return LIST_PERIOD;
    });
  }, [shown, edition]);
  return list;
}

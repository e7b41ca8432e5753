/** The runs that fit a query, and one of them as a recording that plots and events read like a mission. */
import { useEffect, useState } from "react";
import { Refusal } from "../../api/refusal";
import { listRuns, readEvents, readRun, readTicks } from "../../api/service";
import type { Run, RunPage, RunSummary } from "../../api/types";
import { MissionStore } from "../../store/mission";
import { samplesOfTable } from "../../source/quantities";
import { usePageVisible } from "../../ui/use-page-visible";
import { requestOf, type LibraryQuery } from "./query";

/** Milliseconds between two looks: while a run of the page flies, and else. */
const LIVELY_PERIOD = 2000;
const CALM_PERIOD = 10_000;
const RUN_PERIOD = 1000;
const POINTS = 4000;

export const isUnderWay = (run: RunSummary): boolean => run.status === "queued" || run.status === "running";

export interface Library {
  readonly runs: readonly RunSummary[];
  readonly total: number;
  readonly unreadable: RunPage["unreadable"];
  readonly refusal: Refusal | null;
  readonly read: boolean;
}

const EMPTY: Library = { runs: [], total: 0, unreadable: [], refusal: null, read: false };

/** A page of the library, looked at again while it is shown: what has not changed is not sent again. */
export function useLibrary(shown: boolean, query: LibraryQuery, edition: number): Library {
  const [library, setLibrary] = useState(EMPTY);
  const visible = usePageVisible();
  useEffect(() => {
    if (!shown || !visible) return undefined;
    let wanted = true;
    let timer: ReturnType<typeof setTimeout> | undefined;
    let known: string | null = null;
    let lively = false;
    const look = async (): Promise<void> => {
      try {
        const found = await listRuns(requestOf(query), known);
        if (found !== null && wanted) {
          known = found.tag;
          lively = found.body.runs.some(isUnderWay);
          setLibrary({ ...found.body, refusal: null, read: true });
        }
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        known = null;
        if (wanted) setLibrary((before) => ({ ...before, refusal: cause }));
      }
      if (wanted) timer = setTimeout(() => void look(), lively ? LIVELY_PERIOD : CALM_PERIOD);
    };
    void look();
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [shown, visible, query, edition]);
  return library;
}

export interface Recording {
  readonly run: Run;
  /** Null while the run has no log. */
  readonly store: MissionStore | null;
}

async function readRecording(id: string): Promise<Recording> {
  const run = await readRun(id);
  if (run.ticks === 0) return { run, store: null };
  const [table, events] = await Promise.all([readTicks(id, POINTS), readEvents(id)]);
  const store = new MissionStore();
  store.recording(samplesOfTable(table), events, run.outcome?.contacts ?? []);
  return { run, store };
}

/** One run with what was recorded of it; read again while it flies and somebody looks. */
export function useRecording(id: string, edition: number): { readonly recording: Recording | null; readonly refusal: Refusal | null } {
  const [state, setState] = useState<{ recording: Recording | null; refusal: Refusal | null }>({ recording: null, refusal: null });
  const visible = usePageVisible();
  useEffect(() => {
    if (id === "" || !visible) return undefined;
    let wanted = true;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const look = async (): Promise<void> => {
      try {
        const recording = await readRecording(id);
        if (!wanted) return;
        setState({ recording, refusal: null });
        if (isUnderWay(recording.run)) timer = setTimeout(() => void look(), RUN_PERIOD);
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        if (wanted) setState({ recording: null, refusal: cause });
      }
    };
    void look();
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [id, edition, visible]);
  return state.recording?.run.id === id || state.refusal !== null ? state : { recording: null, refusal: null };
}

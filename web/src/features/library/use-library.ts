/** The runs that fit a filter, and one of them as a recording that plots and events read like a mission. */
import { useEffect, useState } from "react";
import { Refusal } from "../../api/refusal";
import { listRuns, readEvents, readRun, readTicks } from "../../api/service";
import type { Run, RunPage, RunsQuery, RunSummary } from "../../api/types";
import { MissionStore } from "../../store/mission";
import { samplesOfTable } from "../../store/quantities";

/** Milliseconds between two looks. */
const LIST_PERIOD = 4000;
const RUN_PERIOD = 1000;
/** Milliseconds after the last key of a search. */
const TYPING_PAUSE = 250;
const PAGE = 50;
const POINTS = 4000;

export const isUnderWay = (run: RunSummary): boolean => run.status === "queued" || run.status === "running";

export interface Library {
  readonly runs: readonly RunSummary[];
  readonly unreadable: RunPage["unreadable"];
  readonly more: boolean;
  readonly refusal: Refusal | null;
  readonly read: boolean;
}

const EMPTY: Library = { runs: [], unreadable: [], more: false, refusal: null, read: false };

/** Up to `pages` pages of the library, read again and again while it is shown. */
export function useLibrary(shown: boolean, query: RunsQuery, pages: number, edition: number): Library {
  const [library, setLibrary] = useState(EMPTY);
  const asked = JSON.stringify(query);
  useEffect(() => {
    if (!shown) return undefined;
    let wanted = true;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const look = async (): Promise<void> => {
      try {
        const found = await readPages(JSON.parse(asked) as RunsQuery, pages);
        if (wanted) setLibrary(found);
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        if (wanted) setLibrary((before) => ({ ...before, refusal: cause }));
      }
      if (wanted) timer = setTimeout(() => void look(), LIST_PERIOD);
    };
    timer = setTimeout(() => void look(), TYPING_PAUSE);
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [shown, asked, pages, edition]);
  return library;
}

async function readPages(query: RunsQuery, pages: number): Promise<Library> {
  const runs: RunSummary[] = [];
  let unreadable: RunPage["unreadable"] = [];
  let cursor: string | null = null;
  for (let page = 0; page < pages; page += 1) {
    const found: RunPage = await listRuns({ ...query, limit: PAGE, ...(cursor === null ? {} : { cursor }) });
    runs.push(...found.runs);
    if (page === 0) unreadable = found.unreadable;
    cursor = found.next_cursor;
    if (cursor === null) break;
  }
  return { runs, unreadable, more: cursor !== null, refusal: null, read: true };
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

/** One run with what was recorded of it; read again while it flies. */
export function useRecording(id: string, edition: number): { readonly recording: Recording | null; readonly refusal: Refusal | null } {
  const [state, setState] = useState<{ recording: Recording | null; refusal: Refusal | null }>({ recording: null, refusal: null });
  useEffect(() => {
    if (id === "") return undefined;
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
  }, [id, edition]);
  return state.recording?.run.id === id || state.refusal !== null ? state : { recording: null, refusal: null };
}

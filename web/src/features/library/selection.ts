/** Which runs are selected, over pages and filters: what is done at once is done with all of them. */
import { useCallback, useMemo, useState } from "react";
import type { RunSummary } from "../../api/types";

export type Selected = ReadonlyMap<string, RunSummary>;

/** Those runs selected, or no more. */
export function withRuns(selected: Selected, runs: readonly RunSummary[], chosen: boolean): Selected {
  const next = new Map(selected);
  for (const run of runs) {
    if (chosen) next.set(run.id, run);
    else next.delete(run.id);
  }
  return next;
}

/** The runs of a page from the one that was pressed last to this one, whichever stands first; this one alone without. */
export function rangeBetween(runs: readonly RunSummary[], last: string | null, id: string): readonly RunSummary[] {
  const places = [last, id].map((each) => runs.findIndex((run) => run.id === each)).sort((one, other) => one - other);
  const [from = -1, to = -1] = places;
  return from < 0 ? runs.filter((run) => run.id === id) : runs.slice(from, to + 1);
}

/** How much of a page is selected. */
export function extentOf(selected: Selected, runs: readonly RunSummary[]): "none" | "some" | "all" {
  const count = runs.filter(({ id }) => selected.has(id)).length;
  if (count === 0) return "none";
  return count === runs.length ? "all" : "some";
}

export interface Selection {
  readonly selected: Selected;
  /** @param extend everything between this one and the one that was pressed before. */
  readonly press: (runs: readonly RunSummary[], id: string, extend: boolean) => void;
  readonly set: (runs: readonly RunSummary[], chosen: boolean) => void;
  readonly clear: () => void;
}

export function useSelection(): Selection {
  const [selected, setSelected] = useState<Selected>(new Map());
  const [last, setLast] = useState<string | null>(null);
  const set = useCallback((runs: readonly RunSummary[], chosen: boolean) => {
    setSelected((before) => withRuns(before, runs, chosen));
  }, []);
  return useMemo(
    () => ({
      selected,
      set,
      press: (runs, id, extend) => {
        set(rangeBetween(runs, extend ? last : null, id), !selected.has(id));
        setLast(id);
      },
      clear: () => {
        setSelected(new Map());
        setLast(null);
      },
    }),
    [selected, last, set],
  );
}

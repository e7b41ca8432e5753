/** Has the plots within show what was rehearsed of the run that they show. */
import { useMemo, type ReactNode } from "react";
import type { Run } from "../../api/types";
import { useSnapshot, useView } from "../../store/context";
import { PredictionContext } from "../plots/prediction";
import { useRehearsal, useRehearsalDesk } from "./context";
import type { Finished } from "./desk";
import { predictionOf } from "./prediction";

/** Of the live mission: until a reset, which is another run, or until it is taken away. */
export function LivePrediction({ children }: { readonly children: ReactNode }) {
  const desk = useRehearsalDesk();
  const config = useView((view) => view.config);
  const run = useSnapshot((snapshot) => snapshot.run_id);
  const finished = useRehearsal((view) => (view.plotted && view.finished?.run === run ? view.finished : null));
  const prediction = useMemo(() => finished && predictionOf(finished.result, config, () => { desk.plot(false); }), [finished, config, desk]);
  return <PredictionContext value={prediction}>{children}</PredictionContext>;
}

/** The rehearsal that a run began with, if this page has made one. */
export const useKept = (run: string): Finished | null => useRehearsal((view) => view.kept.get(run) ?? null);

/** Of a stored run: what was rehearsed of it in this page, with the configuration that it was flown with. */
export function StoredPrediction({ run, children }: { readonly run: Run; readonly children: ReactNode }) {
  const finished = useKept(run.id);
  const prediction = useMemo(() => finished && predictionOf(finished.result, run.config, null), [finished, run.config]);
  return <PredictionContext value={prediction}>{children}</PredictionContext>;
}

/** Has the plots within show what was rehearsed of the run that they show. */
import { useQuery } from "@tanstack/react-query";
import { useMemo, type ReactNode } from "react";
import { readForeseen } from "../../api/service";
import type { RehearsalResult, Run } from "../../api/types";
import { useSnapshot, useView } from "../../store/context";
import { PredictionContext } from "../plots/prediction";
import { useRehearsal, useRehearsalDesk } from "./context";
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

/** What was foreseen of a run when its sequence began; null if nothing was, or as long as it is not known. */
export function useForeseen({ id, kind, status }: Run): RehearsalResult | null {
  // Its status is part of the key: what is foreseen of a run that is open here is kept when its sequence begins.
  const found = useQuery({ queryKey: ["foreseen", id, status], queryFn: () => readForeseen(id), enabled: kind !== "scripted", staleTime: Infinity });
  return found.data ?? null;
}

/** Of a stored run, with the configuration that it was flown with. */
export function StoredPrediction({ run, children }: { readonly run: Run; readonly children: ReactNode }) {
  const foreseen = useForeseen(run);
  const prediction = useMemo(() => foreseen && predictionOf(foreseen, run.config, null), [foreseen, run.config]);
  return <PredictionContext value={prediction}>{children}</PredictionContext>;
}

/** What a press of Rehearse does, wherever the button stands, and why it may not be pressed. */
import { useSnapshot } from "../../store/context";
import { useReasonByRole } from "../access/session";
import { patchOf } from "../parameters/draft";
import { useStaging } from "../parameters/staging";
import { useRehearsalDesk, useStoredMoment } from "./context";
import { faultsOf, rehearsalOf, usePlan } from "./plan";
import { useUncertaintyFields } from "./Uncertainty";

interface Rehearse {
  readonly reason: string | null;
  readonly rehearse: () => void;
}

export function useRehearse(): Rehearse {
  const desk = useRehearsalDesk();
  const { plan } = usePlan();
  const { changes, unsound } = useStaging();
  const fields = useUncertaintyFields();
  const byRole = useReasonByRole("operator");
  const moment = useStoredMoment();
  const phase = useSnapshot((snapshot) => snapshot.phase);
  const run = useSnapshot((snapshot) => snapshot.run_id);
  const faulty = faultsOf(plan, fields).size > 0;
  const reasons = [
    byRole,
    unsound > 0 ? "Correct the staged values first." : null,
    faulty ? "Correct what is asked of the rehearsal first." : null,
  ];
  return {
    reason: reasons.find((reason) => reason !== null) ?? null,
    rehearse: () => void desk.rehearse(rehearsalOf(plan, fields, moment ?? { run: null, at: null, phase }, patchOf(changes)), moment?.run ?? run ?? ""),
  };
}

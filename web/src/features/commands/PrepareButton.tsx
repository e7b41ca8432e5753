/** A button of another page that puts something in the live mission's place, at rest: it asks before anything is lost. */
import { Button } from "@mantine/core";
import { useState } from "react";
import type { CommandRequest } from "../../api/types";
import { go } from "../../store/route";
import { useSnapshot, useView } from "../../store/context";
import { useReasonAgainstCommanding } from "../control/control";
import { useWhatIsLost } from "../mission/lost";
import { RESET } from "./catalogue";
import { cautionOf, reasonAgainst } from "./CommandButton";
import { useDesk, useDeskView } from "./context";
import { isSame, type Answer } from "./desk";
import styles from "./PrepareButton.module.css";
import { ARMED_STYLE, SecondsLeft } from "./SecondsLeft";

interface PrepareButtonProps {
  readonly label: string;
  readonly request: CommandRequest;
  /** Why this cannot be asked for as it is; null if it can. */
  readonly disabledReason?: string | null;
}

function AnswerNote({ answer }: { readonly answer: Answer }) {
  if (answer.verdict === "accepted" || answer.verdict === "waiting") return null;
  return (
    <p className={styles.note} role={answer.verdict === "armed" ? "status" : "alert"} data-verdict={answer.verdict}>
      {`${answer.words} ${answer.tip}`}
    </p>
  );
}

export function PrepareButton({ label, request, disabledReason = null }: PrepareButtonProps) {
  const desk = useDesk();
  const lost = useWhatIsLost();
  const byWho = useReasonAgainstCommanding();
  const byMission = useView((view) => reasonAgainst(view, request.command));
  const reason = byWho ?? byMission ?? disabledReason;
  const byService = useSnapshot((snapshot) => snapshot.arming_needed.includes(request.command)) ?? false;
  const waiting = useDeskView((view) => view.waiting.has(request.command));
  const armed = useDeskView((view) => (view.armed !== null && isSame(view.armed.request, request) ? view.armed : null));
  const [answer, setAnswer] = useState<Answer | null>(null);
  const press = async (): Promise<void> => {
    if (reason !== null) {
      setAnswer({ order: request.command, verdict: "refused", words: reason, tip: "" });
      return;
    }
    const answered = await desk.press(request, cautionOf(RESET.withRobot ?? "", byService, lost));
    setAnswer(answered);
    if (answered.verdict === "accepted") go("mission");
  };
  return (
    <>
      <Button
        variant="filled"
        {...(armed && ARMED_STYLE)}
        // Not `disabled`: data are late for a moment where a machine is busy, and a press then must not be lost unsaid.
        data-disabled={reason !== null}
        aria-disabled={reason !== null}
        title={reason ?? undefined}
        loading={waiting}
        aria-label={armed === null ? label : `Go: ${label}`}
        onClick={() => void press()}
        onBlur={() => {
          if (armed) desk.disarm();
        }}
      >
        {armed === null ? label : <SecondsLeft until={armed.until} />}
      </Button>
      {answer !== null && (answer.verdict !== "armed" || armed !== null) && <AnswerNote answer={answer} />}
    </>
  );
}

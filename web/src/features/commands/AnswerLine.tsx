/** What the service said to the last command. */
import { Icon, type IconName } from "../../ui/theme/Icon";
import { labelOf } from "./catalogue";
import { useDeskView } from "./context";
import type { Answer, Verdict } from "./desk";
import styles from "./AnswerLine.module.css";

const ICONS: Readonly<Record<Verdict, IconName>> = { armed: "warning", waiting: "wait", accepted: "check", refused: "cross", postponed: "wait", unknown: "warning" };
const WORDS: Readonly<Record<Verdict, string>> = {
  armed: "is armed",
  waiting: "waiting for the answer",
  accepted: "accepted",
  refused: "refused",
  postponed: "not yet",
  unknown: "no answer",
};

function sentence(answer: Answer): string {
  if (answer.verdict !== "unknown") return answer.words;
  return `${answer.words} It is not known whether it was carried out; the phase shows it.`;
}

export function AnswerLine() {
  const answer = useDeskView((view) => view.answer);
  return (
    <div className={styles.line} role="status" aria-live="polite" data-verdict={answer?.verdict}>
      {answer === null ? (
        <span className={styles.words}>No command yet.</span>
      ) : (
        <>
          <Icon icon={ICONS[answer.verdict]} />
          <p className={styles.words} title={`${sentence(answer)} ${answer.tip}`}>
            <strong>
              {labelOf(answer.order)} {WORDS[answer.verdict]}
            </strong>{" "}
            {sentence(answer)}
            {answer.verdict === "postponed" && <span className={styles.tip}>{answer.tip}</span>}
          </p>
        </>
      )}
    </div>
  );
}

import { useSnapshot } from "../../store/context";
import { Icon } from "../../theme/Icon";
import { useDesk, useDeskView } from "./context";
import type { Verdict } from "./desk";
import { STOP_KEY_LABEL, useStopKey } from "./stop-key";
import styles from "./StopButton.module.css";

const THIS_PAGE = { window };

const WORDS: Readonly<Record<Verdict, string>> = {
  armed: "",
  waiting: "Stopping",
  accepted: "Stopped",
  refused: "Not confirmed",
  unknown: "Not confirmed",
};

/** Always there, always enabled, one press. */
export function StopButton() {
  const desk = useDesk();
  const latest = useDeskView((view) => view.stop);
  const stopped = useSnapshot((snapshot) => snapshot.phase === "stopped") ?? false;
  useStopKey(THIS_PAGE);
  // An old answer says nothing about a mission that has begun anew, nor a failed one about one that did stop.
  const answer = latest?.verdict === "waiting" || (latest?.verdict === "accepted") === stopped ? latest : null;
  const failed = answer !== null && (answer.verdict === "refused" || answer.verdict === "unknown");
  return (
    <div className={styles.place}>
      <p className={styles.answer} role="status" aria-live="assertive" data-failed={failed || undefined}>
        {answer !== null && WORDS[answer.verdict]}
        {failed && <span>press again, or stop the robot itself</span>}
      </p>
      <button
        type="button"
        className={styles.stop}
        aria-keyshortcuts="Escape"
        onClick={() => {
          void desk.stop();
        }}
      >
        <Icon sign="stop" size={18} />
        STOP
        <kbd className={styles.key}>{STOP_KEY_LABEL}</kbd>
      </button>
    </div>
  );
}

/** The sequence from idle to holding: what is done, what is under way, what will come. */
import { useSnapshot, useStore } from "../../store/context";
import { isPhase, NOMINAL, PHASE_WORDS, type Phase } from "../../store/phases";
import type { PhaseSpan } from "../../store/series";
import { Icon, type Sign } from "../../theme/Icon";
import { fixed } from "../../units/units";
import styles from "./PhaseTimeline.module.css";

type State = "done" | "now" | "ahead";

interface Stage {
  readonly phase: Phase;
  readonly state: State;
  /** Time spent in it; null if it was not entered. */
  readonly lasted: number | null;
}

/** Stages as a person reads them: the nominal sequence, and after it whatever took its place. */
export function stagesOf(spans: readonly PhaseSpan[], phase: Phase | null): Stage[] {
  const nominal = phase === null || NOMINAL.includes(phase);
  const order: readonly Phase[] = nominal ? NOMINAL : [...NOMINAL, phase];
  const place = phase === null ? -1 : order.indexOf(phase);
  return order.map((stage, index) => {
    const lasted = spans.filter((span) => span.phase === stage).reduce((sum, span) => sum + span.end - span.start, 0);
    const entered = spans.some((span) => span.phase === stage);
    const passed = entered || (nominal && index < place);
    return { phase: stage, state: stage === phase ? "now" : passed ? "done" : "ahead", lasted: entered ? lasted : null };
  });
}

const OFF_NOMINAL: Readonly<Partial<Record<Phase, Sign>>> = { stopped: "stop", faulted: "error", released: "follow" };

function StageItem({ stage, activity }: { readonly stage: Stage; readonly activity: string }) {
  const detail = stage.state === "now" && activity !== "none" ? activity : null;
  return (
    <li className={styles.stage} data-state={stage.state} data-phase={stage.phase} aria-current={stage.state === "now" ? "step" : undefined}>
      <span className={styles.name}>
        {stage.state === "done" && <Icon sign="check" size={12} />}
        {stage.state === "now" && <Icon sign={OFF_NOMINAL[stage.phase] ?? "play"} size={10} />}
        {PHASE_WORDS[stage.phase]}
      </span>
      <span className={styles.detail}>
        {detail} {stage.lasted !== null && <span className={styles.lasted}>{fixed(stage.lasted, 1)} s</span>}
      </span>
    </li>
  );
}

export function PhaseTimeline() {
  const store = useStore();
  const word = useSnapshot((snapshot) => snapshot.phase) ?? "";
  const activity = useSnapshot((snapshot) => snapshot.activity) ?? "none";
  // The time in the present phase grows by a tenth of a second at a time.
  useSnapshot((snapshot) => Math.floor(snapshot.time * 10));
  const phase = isPhase(word) ? word : null;
  return (
    <ol className={styles.timeline} aria-label="Phases">
      {stagesOf(store.series.phaseSpans(), phase).map((stage) => (
        <StageItem key={stage.phase} stage={stage} activity={activity} />
      ))}
    </ol>
  );
}

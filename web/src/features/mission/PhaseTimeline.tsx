/** The sequence from idle to holding: what is done, what failed or was skipped, what is under way, what will come. */
import { Tooltip } from "@mantine/core";
import { memo } from "react";
import type { MissionSnapshot } from "../../api/types";
import { useSnapshot } from "../../store/context";
import { isPhase, PHASE_WORDS, type Phase } from "../../source/phases";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { duration } from "../../units/units";
import styles from "./PhaseTimeline.module.css";

type Stage = MissionSnapshot["stages"][number];

const ENDED: Readonly<Partial<Record<Stage["state"], IconName>>> = { done: "check", failed: "cross", skipped: "bar" };
const OFF_NOMINAL: Readonly<Partial<Record<Phase, IconName>>> = { stopped: "stop", faulted: "error", released: "follow" };

function iconOf({ phase, state }: Stage): IconName | null {
  if (state === "now") return (isPhase(phase) ? OFF_NOMINAL[phase] : undefined) ?? "play";
  return ENDED[state] ?? null;
}

const StageItem = memo(function StageItem({ stage, activity }: { readonly stage: Stage; readonly activity: string }) {
  const icon = iconOf(stage);
  const detail = stage.state === "now" && activity !== "none" ? activity : null;
  return (
    <Tooltip label={`${stage.state}: ${stage.why}`} disabled={stage.why === ""} position="bottom">
      <li className={styles.stage} data-state={stage.state} data-phase={stage.phase} aria-current={stage.state === "now" ? "step" : undefined}>
        <span className={styles.name}>
          {icon !== null && <Icon icon={icon} size={stage.state === "now" ? 10 : 12} />}
          {isPhase(stage.phase) ? PHASE_WORDS[stage.phase] : stage.phase}
          {stage.state !== "now" && <span className="visually-hidden">{stage.state === "ahead" ? "not yet" : `${stage.state} ${stage.why}`}</span>}
        </span>
        <span className={styles.detail}>
          {stage.state === "failed" || stage.state === "skipped" ? stage.state : detail}{" "}
          {stage.lasted !== null && <span className={styles.lasted}>{duration(stage.lasted)}</span>}
        </span>
      </li>
    </Tooltip>
  );
});

export function PhaseTimeline() {
  const stages = useSnapshot((snapshot) => snapshot.stages) ?? [];
  const activity = useSnapshot((snapshot) => snapshot.activity) ?? "none";
  return (
    <ol className={styles.timeline} aria-label="Phases">
      {stages.map((stage) => (
        <StageItem key={stage.phase} stage={stage} activity={activity} />
      ))}
    </ol>
  );
}

/** How fresh the data are, how the loop that makes them keeps its time, and whether they are being recorded. */
import { Tooltip } from "@mantine/core";
import type { Health } from "../api/types";
import { useSnapshot, useView } from "../store/context";
import { fixed } from "../units/units";
import styles from "./LinkState.module.css";

const WORDS = { connecting: "Connecting", preparing: "Preparing", live: "Live", stale: "Stale" } as const;

function recorderWords(health: Health | null): string {
  if (health === null) return "";
  if (health.recorder_failure !== null) return `The run is NOT being recorded: ${health.recorder_failure}.`;
  return `The recorder is ${fixed(health.recorder_lag, 1)} s behind at most.`;
}

/** What a person who asks for more is told. */
function usePunctuality(): string {
  const lateness = useSnapshot((snapshot) => snapshot.plant.lateness) ?? 0;
  const factor = useSnapshot((snapshot) => snapshot.plant.real_time_factor) ?? 0;
  const answer = useView((view) => view.answerTime);
  const health = useView((view) => view.health);
  const parts = [
    `Worst lateness of a control tick in the last second: ${fixed(lateness * 1000, 2)} ms.`,
    `The mission runs at ${fixed(factor, 2)} times real time.`,
    answer === null ? "The service does not answer." : `The service answers within ${fixed(answer, 0)} ms.`,
    recorderWords(health),
    `Becalm ${health?.version ?? ""}`,
  ];
  return parts.join(" ");
}

export function LinkState() {
  const trust = useView((view) => view.trust);
  const age = useView((view) => view.age);
  const lateness = useSnapshot((snapshot) => snapshot.plant.lateness) ?? 0;
  const unrecorded = useView((view) => typeof view.health?.recorder_failure === "string");
  const words = usePunctuality();
  const late = unrecorded ? "not recorded" : `tick ≤ ${fixed(lateness * 1000, 1)} ms late`;
  return (
    <Tooltip label={words}>
      <div className={styles.link} data-trust={trust} role="status" aria-live="polite" aria-label={`Data: ${WORDS[trust]}`} tabIndex={0}>
        <span className={styles.dot} aria-hidden="true" />
        <span className={styles.word}>{WORDS[trust]}</span>
        {(trust === "live" || trust === "stale") && <span className={styles.detail}>{trust === "stale" ? `${fixed(age / 1000, 1)} s old` : late}</span>}
      </div>
    </Tooltip>
  );
}

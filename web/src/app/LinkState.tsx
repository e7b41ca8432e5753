/** How fresh the data are, and how the loop that makes them keeps its time. */
import { Tooltip } from "@mantine/core";
import { useSnapshot, useView } from "../store/context";
import { fixed } from "../units/units";
import styles from "./LinkState.module.css";

const WORDS = { connecting: "Connecting", preparing: "Preparing", live: "Live", stale: "Stale" } as const;

export function LinkState() {
  const trust = useView((view) => view.trust);
  const age = useView((view) => view.age);
  const lateness = useSnapshot((snapshot) => snapshot.plant.lateness);
  const factor = useSnapshot((snapshot) => snapshot.plant.real_time_factor);
  const version = useView((view) => view.health?.version ?? null);
  const detail = trust === "stale" ? `${fixed(age / 1000, 1)} s old` : `tick ≤ ${fixed((lateness ?? 0) * 1000, 1)} ms late`;
  return (
    <Tooltip
      label={`Worst lateness of a control tick in the last second: ${fixed((lateness ?? 0) * 1000, 2)} ms. The simulation runs at ${fixed(factor ?? 0, 2)} times real time. Becalm ${version ?? ""}`}
    >
      <div className={styles.link} data-trust={trust} role="status" aria-live="polite" aria-label={`Data: ${WORDS[trust]}`}>
        <span className={styles.dot} aria-hidden="true" />
        <span className={styles.word}>{WORDS[trust]}</span>
        {(trust === "live" || trust === "stale") && <span className={styles.detail}>{detail}</span>}
      </div>
    </Tooltip>
  );
}

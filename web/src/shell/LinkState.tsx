/** How fresh the data are, how the loop that makes them keeps its time, and whether they are being recorded. */
import { Tooltip } from "@mantine/core";
import type { Health } from "../api/types";
import { useSnapshot, useView } from "../store/context";
import { duration, fixed } from "../units/units";
import styles from "./LinkState.module.css";

const WORDS = { connecting: "Connecting", preparing: "Preparing", live: "Live", stale: "Stale" } as const;

function recorderWords(health: Health | null): string {
  if (health === null) return "";
  if (health.recorder_failure !== null) return `The run is NOT being recorded: ${health.recorder_failure}.`;
  return `The recorder is ${duration(health.recorder_lag)} behind at most.`;
}

/** What a person who asks for more is told. */
function usePunctuality(): string {
  const lateness = useSnapshot((snapshot) => fixed(snapshot.plant.lateness * 1000, 1)) ?? "0.0";
  const factor = useSnapshot((snapshot) => fixed(snapshot.plant.real_time_factor, 2)) ?? "0.00";
  const answer = useView((view) => view.answerTime);
  const health = useView((view) => view.health);
  const parts = [
    `Worst lateness of a control tick in the last second: ${lateness} ms.`,
    `The mission runs at ${factor} times real time.`,
    answer === null ? "The service does not answer." : `The service answers within ${fixed(answer, 0)} ms.`,
    recorderWords(health),
    `Becalm ${health?.version ?? ""}`,
  ];
  return parts.join(" ");
}

interface Freshness {
  readonly word: string;
  readonly detail: string;
}

/** The service and the robot are told apart: one may be live while the other is silent. */
function useFreshness(): Freshness {
  const trust = useView((view) => view.trust);
  const age = useView((view) => view.age);
  const robotAge = useView((view) => view.robotAge);
  const silent = useSnapshot((snapshot) => (snapshot.robot?.silent_for ?? 0) > 0.5) ?? false;
  const stream = useSnapshot((snapshot) => snapshot.robot?.stream) ?? "";
  const lateness = useSnapshot((snapshot) => fixed(snapshot.plant.lateness * 1000, 1)) ?? "0.0";
  const unrecorded = useView((view) => typeof view.health?.recorder_failure === "string");
  if (trust === "stale") return { word: WORDS.stale, detail: `${duration(age / 1000)} old` };
  if (trust !== "live") return { word: WORDS[trust], detail: "" };
  if (robotAge > 0) return { word: "Service live", detail: `${silent ? "robot silent" : `${stream} silent`} for ${duration(robotAge / 1000)}` };
  return { word: WORDS.live, detail: unrecorded ? "not recorded" : `ticks up to ${lateness} ms late` };
}

export function LinkState() {
  const { word, detail } = useFreshness();
  const trust = useView((view) => (view.trust === "live" && view.robotAge > 0 ? "stale" : view.trust));
  const words = usePunctuality();
  return (
    <Tooltip label={words} position="bottom-start">
      <div className={styles.link} data-trust={trust} role="status" aria-live="polite" aria-label={`Data: ${word}`} tabIndex={0}>
        <span className={styles.dot} aria-hidden="true" />
        <span className={styles.word}>{word}</span>
        {detail !== "" && <span className={styles.detail}>{detail}</span>}
      </div>
    </Tooltip>
  );
}

/** Clocks, latency and thresholds, each as one number. */
import type { ReactNode } from "react";
import { Panel } from "../../ui/Panel";
import type { LinkStatus } from "../../api/types";
import { fixed } from "../../units/units";
import styles from "./LinkPage.module.css";
import { milliseconds, offsetWords } from "./labels";

function Figure({ label, value, remark }: { readonly label: string; readonly value: string; readonly remark: ReactNode }) {
  return (
    <div role="group" aria-label={label}>
      <dt>{label}</dt>
      <dd>{value}</dd>
      <dd className={styles.remark}>{remark}</dd>
    </div>
  );
}

export function TimingPanel({ link }: { readonly link: LinkStatus }) {
  const offset = offsetWords(link.clock_offset);
  const { round_trip: trip, command_age: ages } = link;
  return (
    <Panel title="Timing" dated="service">
      <dl className={styles.figures}>
        <Figure label="Round trip" value={`${milliseconds(trip?.p99 ?? null)} ms`} remark={`99 %, median ${milliseconds(trip?.p50 ?? null)} ms`} />
        <Figure label="Command age" value={`${milliseconds(ages?.p99 ?? null)} ms`} remark={`99 %, median ${milliseconds(ages?.p50 ?? null)} ms`} />
        <Figure label="Clock offset" value={offset.value} remark={offset.sense} />
        <Figure label="Deadline" value={`${milliseconds(link.deadline, 0)} ms`} remark="for every required stream" />
        <Figure
          label="Contact threshold"
          value={link.contact_threshold === null ? "—" : `${fixed(link.contact_threshold, 2)} N`}
          remark="at a wrist"
        />
      </dl>
    </Panel>
  );
}

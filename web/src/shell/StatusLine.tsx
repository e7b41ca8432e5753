/** How far the data are to be trusted, on every page; what is flown while they are, and what is amiss while not. */
import { useSnapshot, useView } from "../store/context";
import { isPhase, PHASE_WORDS } from "../source/phases";
import { AlarmState } from "../features/alarms/AlarmState";
import { LinkState } from "./LinkState";
import styles from "./StatusLine.module.css";
import { TrustNotice } from "./TrustNotice";

/** On its own page the mission's strip tells the phase; elsewhere it stands here. */
function MissionFacts({ phased }: { readonly phased: boolean }) {
  const configuration = useSnapshot((snapshot) => snapshot.configuration);
  const run = useSnapshot((snapshot) => snapshot.run_id);
  const phase = useSnapshot((snapshot) => snapshot.phase);
  const robot = useSnapshot((snapshot) => snapshot.plant.kind === "zenoh") ?? false;
  const engine = useView((view) => view.config?.simulation.engine ?? null);
  return (
    <dl className={styles.facts}>
      {phased && (
        <div>
          <dt>Phase</dt>
          <dd>{phase !== null && isPhase(phase) ? PHASE_WORDS[phase] : "—"}</dd>
        </div>
      )}
      <div>
        <dt>Configuration</dt>
        <dd title={configuration ?? undefined}>{configuration ?? "—"}</dd>
      </div>
      <div>
        <dt>{robot ? "Plant" : "Engine"}</dt>
        <dd title={robot ? "A robot at the other end of zenoh" : "simulation.engine: what simulates this mission"}>{robot ? "robot" : (engine ?? "—")}</dd>
      </div>
      <div>
        <dt>Run</dt>
        <dd className={styles.run}>{run ?? "—"}</dd>
      </div>
    </dl>
  );
}

/** Always there and always as high: nothing below it moves when the data grow old, and nothing is covered. */
export function StatusLine({ phased }: { readonly phased: boolean }) {
  const trusted = useView((view) => view.trust === "live" && view.robotAge === 0);
  return (
    <section className={styles.line} aria-label="Data status">
      <LinkState />
      <AlarmState />
      {trusted ? <MissionFacts phased={phased} /> : <TrustNotice />}
    </section>
  );
}

/** The robot at the other end: what it does, for whom, and how well it is heard. */
import { useView } from "../../store/context";
import { LatencyPlot } from "./LatencyPlot";
import styles from "./LinkPage.module.css";
import { RobotPanel } from "./RobotPanel";
import { StreamTable } from "./StreamTable";
import { TimingPanel } from "./TimingPanel";
import { useLink } from "./use-link";

const EMULATOR = "becalm robot --listen tcp/127.0.0.1:7447";
const CONSOLE = "becalm serve --plant zenoh --connect tcp/127.0.0.1:7447";

function Simulated() {
  return (
    <section className={styles.simulated} aria-label="No robot">
      <h2>Simulation: there is no robot link</h2>
      <p>
        With one setting the same console, controller and log fly a robot over zenoh. Without a robot, start an emulated air-bearing
        testbed with noise, delay and faults on demand:
      </p>
      <pre tabIndex={0} aria-label="Shell commands">
        <code>
          {EMULATOR}
          {"\n"}
          {CONSOLE}
        </code>
      </pre>
      <p>A ROS 2 robot needs no Becalm code, only the topics of the contract in docs/link.md.</p>
    </section>
  );
}

export function LinkPage({ shown }: { readonly shown: boolean }) {
  const { link, old, refusal } = useLink(shown);
  const trust = useView((view) => view.trust);
  const stale = old || trust === "stale";
  return (
    <main className={styles.page} hidden={!shown} data-trust={stale ? "stale" : undefined} aria-label="Robot link">
      {stale && link?.plant !== "simulation" && (
        <p className={styles.old} role="alert">
          Stale data: {refusal?.message ?? "the service does not answer."}
        </p>
      )}
      {link === null && !stale && <p className={styles.old}>Loading the state of the link.</p>}
      {link?.plant === "simulation" && <Simulated />}
      {link?.plant === "zenoh" && (
        <div className={styles.columns}>
          <div className={styles.side}>
            <RobotPanel link={link} />
            <TimingPanel link={link} />
          </div>
          <div className={styles.wide}>
            <StreamTable link={link} />
            <LatencyPlot link={link} shown={shown} />
          </div>
        </div>
      )}
    </main>
  );
}

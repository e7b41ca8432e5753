/** What is happening now, in one line of sight. */
import { useSnapshot } from "../../store/context";
import { CageCell, ContactCell, DriftCell, NextCell } from "./cells";
import { MissionClock } from "./MissionClock";
import styles from "./MissionStrip.module.css";
import { PhaseTimeline } from "./PhaseTimeline";
import { SpinGauge } from "./SpinGauge";

export function MissionStrip() {
  const description = useSnapshot((snapshot) => snapshot.description);
  return (
    <section className={styles.strip} aria-label="Mission">
      <div className={styles.now}>
        <MissionClock />
        <PhaseTimeline />
        <p className={styles.description} role="status">
          {description ?? "No data yet."}
        </p>
      </div>
      <div className={styles.cells}>
        <SpinGauge />
        <DriftCell />
        <ContactCell />
        <CageCell />
        <NextCell />
      </div>
    </section>
  );
}

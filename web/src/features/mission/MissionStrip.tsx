/** What is happening now, in one line of sight. */
import { NextCell } from "./cells";
import { MissionClock } from "./MissionClock";
import styles from "./MissionStrip.module.css";
import { PhaseTimeline } from "./PhaseTimeline";
import { Cells, Description } from "./Readings";

export function MissionStrip() {
  return (
    <section className={styles.strip} aria-label="Mission">
      <div className={styles.now}>
        <MissionClock />
        <PhaseTimeline />
        <Description announced />
      </div>
      <Cells>
        <NextCell />
      </Cells>
    </section>
  );
}

import { useSnapshot } from "../../store/context";
import { clock, fixed } from "../../units/units";
import styles from "./MissionClock.module.css";

function paceWords(running: boolean, speed: number, factor: number): string {
  if (!running) return "paused";
  if (speed === 0) return `fastest, ${fixed(factor, 0)} × real time`;
  return speed === 1 ? "real time" : `${speed} × real time`;
}

/** Mission time, and how it passes. */
export function MissionClock() {
  const time = useSnapshot((snapshot) => snapshot.time);
  const pace = useSnapshot(({ plant }) => paceWords(plant.running, plant.speed, plant.real_time_factor));
  return (
    <div className={styles.clock}>
      <div role="timer" aria-label="Mission time" className={styles.time}>
        {time === null ? "—" : clock(time)}
      </div>
      <div className={styles.pace}>{pace ?? "mission time"}</div>
    </div>
  );
}

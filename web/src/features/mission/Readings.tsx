/** What happens at the moment that is shown: phases, words, and the readings beside them. */
import type { ReactNode } from "react";
import { useSnapshot } from "../../store/context";
import { CageCell, ContactCell, DriftCell } from "./cells";
import { PhaseTimeline } from "./PhaseTimeline";
import styles from "./Readings.module.css";
import { SpinGauge } from "./SpinGauge";

/** @param announced to screen readers, where it changes by itself */
export function Description({ announced }: { readonly announced: boolean }) {
  const description = useSnapshot((snapshot) => snapshot.description);
  return (
    <p className={styles.description} role={announced ? "status" : undefined}>
      {description ?? "No data yet."}
    </p>
  );
}

/** @param children what stands beside them */
export function Cells({ children }: { readonly children?: ReactNode }) {
  return (
    <div className={styles.cells}>
      <SpinGauge />
      <DriftCell />
      <ContactCell />
      <CageCell />
      {children}
    </div>
  );
}

/** Without the clock, where another one stands beside them. */
export function Readings({ label }: { readonly label: string }) {
  return (
    <section className={styles.readings} aria-label={label}>
      <div className={styles.now}>
        <PhaseTimeline />
        <Description announced={false} />
      </div>
      <Cells />
    </section>
  );
}

import type { ReactNode } from "react";
import styles from "./Cell.module.css";

interface CellProps {
  readonly label: string;
  readonly width: number;
  readonly children: ReactNode;
}

/** A labelled readout of the strip; its width is fixed so that nothing jumps. */
export function Cell({ label, width, children }: CellProps) {
  return (
    <div className={styles.cell} style={{ width }} role="group" aria-label={label}>
      <div className={styles.label}>{label}</div>
      {children}
    </div>
  );
}

/** A number and its unit. */
export function Reading({ value, unit }: { readonly value: string; readonly unit: string }) {
  return (
    <div className={styles.reading}>
      {value}
      <span className={styles.unit}>{unit}</span>
    </div>
  );
}

/** The small line beneath a reading. */
export function Remark({ children }: { readonly children: ReactNode }) {
  return <div className={styles.remark}>{children}</div>;
}

import { memo, type ReactNode } from "react";
import { Term } from "../glossary/Term";
import styles from "./Cell.module.css";

/** Drawn once: what stands below it changes ten times a second. */
const Label = memo(function Label({ label, term }: { readonly label: string; readonly term: string | undefined }) {
  return <div className={styles.label}>{term === undefined ? label : <Term term={term}>{label}</Term>}</div>;
});

interface CellProps {
  readonly label: string;
  /** In the glossary. */
  readonly term?: string;
  readonly width: number;
  readonly children: ReactNode;
}

/** A labelled readout of the strip; its width is fixed so that nothing jumps. */
export function Cell({ label, term, width, children }: CellProps) {
  return (
    <div className={styles.cell} style={{ width }} role="group" aria-label={label}>
      <Label label={label} term={term} />
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

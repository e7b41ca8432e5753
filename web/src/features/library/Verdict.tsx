/** How a run ended, by its verdict; what it is doing, without one. */
import type { RunSummary } from "../../api/types";
import { lookOf } from "../glossary/class-style";
import styles from "./RunTable.module.css";
import { statusWords } from "./words";

/** The mark alone, where words stand beside it. */
export function VerdictMark({ run }: { readonly run: RunSummary }) {
  const look = run.outcome === null ? null : lookOf(run.outcome.outcome);
  return (
    <span className={styles.mark} style={look === null ? undefined : { background: look.colour }} aria-hidden="true">
      {look?.letter ?? "\u00a0"}
    </span>
  );
}

export const verdictWords = (run: RunSummary): string => (run.outcome === null ? statusWords(run) : lookOf(run.outcome.outcome).words);

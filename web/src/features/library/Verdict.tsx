/** How a run ended, by its verdict; what it is doing, without one. */
import type { RunSummary } from "../../api/types";
import { fixed } from "../../units/units";
import { classStyle } from "../glossary/class-style";
import styles from "./RunTable.module.css";
import { statusWords } from "./labels";

/** The mark alone, where words stand beside it. */
export function VerdictMark({ run }: { readonly run: RunSummary }) {
  const style = run.outcome === null ? null : classStyle(run.outcome.outcome);
  return (
    <span className={styles.mark} style={style === null ? undefined : { background: style.colour }} aria-hidden="true">
      {style?.letter ?? "\u00a0"}
    </span>
  );
}

export const verdictWords = (run: RunSummary): string => (run.outcome === null ? statusWords(run) : classStyle(run.outcome.outcome).words);

/** Of a sequence that was not the run's last: class and peak. */
export const outcomeWords = ({ outcome, peak_tip_force }: NonNullable<RunSummary["outcome"]>): string =>
  `${classStyle(outcome).words}, ${fixed(peak_tip_force, 2)} N`;

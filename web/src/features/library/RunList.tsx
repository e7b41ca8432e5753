/** Runs beside the one that is open: enough to tell them apart, and to compare one with it. */
import type { RunSummary } from "../../api/types";
import { fixed } from "../../units/units";
import { runHash, type LibraryQuery } from "./query";
import styles from "./LibraryPage.module.css";
import { VerdictMark, verdictWords } from "./Verdict";
import { changesTitle, changeWords, configurationWords, momentWords } from "./labels";

interface ItemProps {
  readonly run: RunSummary;
  readonly query: LibraryQuery;
  /** The run that is open. */
  readonly open: string;
  /** The run that it is compared with. */
  readonly other: string;
}

/** Puts a run beside the one that is open, or takes it away again. */
function Compare({ run, query, open, other }: ItemProps) {
  const compared = run.id === other;
  return (
    <a className={styles.compare} href={runHash(query, open, compared ? "" : run.id)} aria-current={compared ? "true" : undefined}>
      {compared ? "Compared" : "Compare"}
    </a>
  );
}

function Item({ run, query, open, other }: ItemProps) {
  return (
    <li className={styles.entry}>
      <a className={styles.item} href={runHash(query, run.id)} aria-current={run.id === open ? "true" : undefined}>
        <VerdictMark run={run} />
        <span className={styles.words}>
          <strong>
            {run.starred && <span aria-label="starred">★ </span>}
            {run.name === "" ? verdictWords(run) : run.name}
          </strong>
          <span title={changesTitle(run.changes)}>{[configurationWords(run), ...run.changes.map(changeWords)].join(", ")}</span>
          <span className={styles.when}>{[momentWords(run.started, new Date()), run.kind, ...run.tags].join(" · ")}</span>
        </span>
        <span className={styles.peak}>{run.outcome === null ? "" : `${fixed(run.outcome.peak_tip_force, 2)} N`}</span>
      </a>
      {run.id !== open && run.ticks > 0 && <Compare run={run} query={query} open={open} other={other} />}
    </li>
  );
}

export function RunList({ runs, ...shared }: Omit<ItemProps, "run"> & { readonly runs: readonly RunSummary[] }) {
  return (
    <ul className={styles.list} aria-label="Runs">
      {runs.map((run) => (
        <Item key={run.id} run={run} {...shared} />
      ))}
    </ul>
  );
}

/** Verdicts and measures of the selected runs. */
import { useMemo } from "react";
import type { RunSummary } from "../../api/types";
import { fixed } from "../../units/units";
import { classStyle } from "../glossary/class-style";
import { Term } from "../glossary/Term";
import styles from "./SelectionPanel.module.css";
import { statisticsOf, verdictsOf, type Figures, type VerdictShare } from "./statistics";

const percent = (share: number): string => fixed(100 * share, 0);

function Verdicts({ shares, without }: { readonly shares: readonly VerdictShare[]; readonly without: number }) {
  return (
    <ul className={styles.verdicts} aria-label="Verdicts">
      {shares.map(({ outcome, count, total, low, high }) => (
        <li key={outcome}>
          <span className={styles.bar} aria-hidden="true">
            <i style={{ width: `${(100 * count) / total}%`, background: classStyle(outcome).colour }} />
          </span>
          <Term term={outcome}>{classStyle(outcome).words}</Term>
          <b>{`${count} of ${total}`}</b>
          <small title="Wilson's interval at 95 %">{`${percent(low)} to ${percent(high)} %`}</small>
        </li>
      ))}
      {without > 0 && <li className={styles.without}>{`${without} without a verdict`}</li>}
    </ul>
  );
}

const HEADS = ["Runs", "Mean", "Std. dev.", "Least", "5 %", "Median", "95 %", "Largest"];

const valuesOf = ({ mean, deviation, least, low, median, high, largest }: Figures): readonly number[] => [mean, deviation, least, low, median, high, largest];

export function SelectionStatistics({ runs }: { readonly runs: readonly RunSummary[] }) {
  const [figures, shares] = useMemo(() => [statisticsOf(runs), verdictsOf(runs)], [runs]);
  const without = runs.filter(({ outcome }) => outcome === null).length;
  return (
    <div className={styles.statistics} role="region" aria-label="Statistics of the selected runs" tabIndex={0}>
      <Verdicts shares={shares} without={without} />
      {figures.length > 0 && (
        <table>
          <thead>
            <tr>
              <td />
              {HEADS.map((head) => <th key={head} scope="col">{head}</th>)}
            </tr>
          </thead>
          <tbody>
            {figures.map((each) => (
              <tr key={each.measure.name}>
                <th scope="row"><Term term={each.measure.term}>{each.measure.name}</Term></th>
                <td>{each.count}</td>
                {valuesOf(each).map((value, place) => <td key={HEADS[place]}>{fixed(value, each.measure.decimals)}</td>)}
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </div>
  );
}

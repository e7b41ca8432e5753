/** Two studies in numbers, side by side. */
import type { StudyDetail } from "../../api/types";
import { Panel } from "../../ui/Panel";
import { fixed, plain, shown } from "../../units/units";
import { classStyle } from "../glossary/class-style";
import { Term } from "../glossary/Term";
import { classPairs, measurePairs, type Level } from "./comparison";
import styles from "./StudiesPage.module.css";
import type { Rows } from "./use-study";

interface Shown {
  readonly study: StudyDetail;
  readonly rows: Rows;
}

const percent = (share: number): string => `${fixed(100 * share, 1)} %`;

const digits = (value: number): string => plain(Number(value.toPrecision(3)));

function LevelCell({ level }: { readonly level: Level }) {
  return (
    <td>
      {digits(level.median)}
      <small>{`95 %: ${digits(level.high)}`}</small>
    </td>
  );
}

export function PairPanel({ one, other }: { readonly one: Shown; readonly other: Shown }) {
  const head = (title: string) => (
    <thead>
      <tr>
        <th>{title}</th>
        <th>{one.study.name}</th>
        <th>{other.study.name}</th>
      </tr>
    </thead>
  );
  return (
    <Panel title="Comparison">
      <table className={styles.table}>
        {head("Class")}
        <tbody>
          {classPairs(one.study, other.study).map((pair) => (
            <tr key={pair.name}>
              <td>
                <span className={styles.swatch} style={{ background: classStyle(pair.name).colour }} aria-hidden="true">
                  {classStyle(pair.name).letter}
                </span>
                <Term term={pair.name}>{classStyle(pair.name).words}</Term>
              </td>
              <td>{percent(pair.one)}</td>
              <td>{percent(pair.other)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <table className={styles.table}>
        <caption>Medians over the cells</caption>
        {head("Measure")}
        <tbody>
          {measurePairs(one.study.columns, one.rows, other.rows).map(({ name, unit, one: ours, other: theirs }) => (
            <tr key={name}>
              <td>
                <Term term={name}>{name.replaceAll("_", " ")}</Term>
                {unit !== "1" && ` [${shown(unit, "rad").unit}]`}
              </td>
              <LevelCell level={ours} />
              <LevelCell level={theirs} />
            </tr>
          ))}
        </tbody>
      </table>
    </Panel>
  );
}

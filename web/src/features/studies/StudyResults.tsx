/** How often each class came out, and how far that agrees with the paper. */
import { Panel } from "../../ui/Panel";
import { Term } from "../glossary/Term";
import type { StudyDetail } from "../../api/types";
import { fixed, plain, shown } from "../../units/units";
import { classStyle } from "../glossary/class-style";
import styles from "./StudiesPage.module.css";

const digits = (value: number): string => plain(Number(value.toPrecision(3)));

const percent = (share: number): string => `${fixed(100 * share, 1)} %`;

function OutcomeTable({ study }: { readonly study: StudyDetail }) {
  return (
    <table className={styles.table}>
      <thead>
        <tr>
          <th>Class</th>
          <th>Cells</th>
          <th>Share</th>
        </tr>
      </thead>
      <tbody>
        {study.outcomes.map((share) => (
          <tr key={share.outcome}>
            <td>
              <span className={styles.swatch} style={{ background: classStyle(share.outcome).colour }} aria-hidden="true">
                {classStyle(share.outcome).letter}
              </span>
              <Term term={share.outcome}>{classStyle(share.outcome).words}</Term>
            </td>
            <td>{share.cells}</td>
            <td>
              {percent(share.share)}
              {share.low !== null && share.high !== null && (
                <small title="95 % confidence interval">
                  {fixed(100 * share.low, 0)}–{fixed(100 * share.high, 0)} %
                </small>
              )}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function MeasureTable({ measures }: { readonly measures: StudyDetail["measures"] }) {
  return (
    <table className={styles.table}>
      <caption>Means of the sample, with their 95 % confidence interval</caption>
      <tbody>
        {measures.map(({ measure, unit, mean }) => (
          <tr key={measure}>
            <td>
              <Term term={measure}>{measure.replaceAll("_", " ")}</Term>
              {unit !== "1" && ` [${shown(unit, "rad").unit}]`}
            </td>
            <td>{digits(mean.value)}</td>
            <td>
              <small>{mean.low !== null && mean.high !== null && `${digits(mean.low)} – ${digits(mean.high)}`}</small>
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function AgreementTable({ agreement }: { readonly agreement: NonNullable<StudyDetail["agreement"]> }) {
  return (
    <table className={styles.table}>
      <caption>Agreement with the paper, at the first closure</caption>
      <thead>
        <tr>
          <th>Table</th>
          <th>Same class</th>
          <th>
            <Term term="Cohen's κ">Cohen&apos;s κ</Term>
          </th>
        </tr>
      </thead>
      <tbody>
        {agreement.map((table) => (
          <tr key={table.mass}>
            <td>m = {table.mass} kg</td>
            <td>
              {table.agreeing} of {table.cells} ({percent(table.share)})
            </td>
            <td>{fixed(table.kappa, 2)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

export function StudyResults({ study }: { readonly study: StudyDetail }) {
  return (
    <Panel title="Outcomes">
      <OutcomeTable study={study} />
      {study.measures.length > 0 && <MeasureTable measures={study.measures} />}
      {study.agreement !== null && study.agreement.length > 0 && <AgreementTable agreement={study.agreement} />}
    </Panel>
  );
}

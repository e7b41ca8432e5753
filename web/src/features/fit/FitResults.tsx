/** What a fit found: values with intervals, what the run does not tell, the miss, peak forces, what is left. */
import type { FitResult } from "../../api/types";
import styles from "./Fit.module.css";
import { digits, missBars, peakRows, residualPoints, valueRow, type Channel } from "./words";

const WIDTH = 120;
const HEIGHT = 36;

const percent = (part: number): string => `${100 * part}%`;

function Values({ result }: { readonly result: FitResult }) {
  return (
    <table className={`${styles.table} ${styles.values}`}>
      <thead>
        <tr>
          <th scope="col">Parameter</th>
          <th scope="col">Nominal</th>
          <th scope="col">Fitted</th>
          <th scope="col">95 % interval</th>
        </tr>
      </thead>
      <tbody>
        {result.parameters.map(valueRow).map(({ name, title, nominal, value, interval }) => (
          <tr key={name} title={title}>
            <th scope="row">{name}</th>
            <td>{nominal}</td>
            {value === null ? <td colSpan={2}>not told</td> : <td>{value}</td>}
            {interval !== null && <td>{interval}</td>}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Miss({ miss }: { readonly miss: NonNullable<FitResult["miss"]> }) {
  return (
    <section aria-label="The miss, taken apart">
      <h3>{`The touch at ${miss.time.toFixed(2)} s: foretold, and measured`}</h3>
      <ul className={styles.bars}>
        {missBars(miss).map(({ name, words, left, width, kind }) => (
          <li key={name}>
            <span>{name}</span>
            <div className={styles.track} aria-hidden="true">
              <i data-kind={kind} style={{ left: percent(left), width: percent(Math.max(0.004, width)) }} />
            </div>
            <span>{words}</span>
          </li>
        ))}
      </ul>
    </section>
  );
}

function Peaks({ result }: { readonly result: FitResult }) {
  const rows = peakRows(result);
  if (rows.length === 0) return null;
  return (
    <table className={styles.table}>
      <caption>Peak force of each touch, foretold from the flight before it [N]</caption>
      <thead>
        <tr>
          <th scope="col">Touch</th>
          <th scope="col">Measured</th>
          <th scope="col">Nominal</th>
          <th scope="col">Fitted</th>
        </tr>
      </thead>
      <tbody>
        {rows.map(({ key, words, heldOut, measured, nominal, fitted }) => (
          <tr key={key} data-held-out={heldOut || undefined}>
            <th scope="row">{heldOut ? `${words}, held out` : words}</th>
            <td>{digits(measured, 3)}</td>
            <td>{digits(nominal, 3)}</td>
            <td>{digits(fitted, 3)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Residual({ channel }: { readonly channel: Channel }) {
  const { points, band } = residualPoints(channel, WIDTH, HEIGHT);
  const words = `${channel.run}, ${channel.name} [${channel.unit}]: ${digits(channel.rms, 2)} is left, ${digits(channel.rms_nominal, 2)} with nominal values`;
  return (
    <figure title={words}>
      <figcaption>{`${channel.name} ±${digits(channel.rms, 2)} ${channel.unit}`}</figcaption>
      <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} preserveAspectRatio="none" role="img" aria-label={words}>
        <rect x="0" y={band[0]} width={WIDTH} height={band[1] - band[0]} />
        <path d={points} vectorEffect="non-scaling-stroke" />
      </svg>
    </figure>
  );
}

function Said({ title, lines }: { readonly title: string; readonly lines: readonly string[] }) {
  if (lines.length === 0) return null;
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      <ul className={styles.said}>
        {lines.map((line) => (
          <li key={line}>{line}</li>
        ))}
      </ul>
    </section>
  );
}

export function FitResults({ result }: { readonly result: FitResult }) {
  return (
    <div className={styles.results}>
      <Values result={result} />
      <Said title="What the run does not tell, or only together" lines={result.indistinct} />
      {result.miss !== null && <Miss miss={result.miss} />}
      <Peaks result={result} />
      <details className={styles.fold}>
        <summary>
          What is left of the readings <span>{result.channels.length}</span>
        </summary>
        <div className={styles.residuals}>
          {result.channels.map((channel) => (
            <Residual key={`${channel.run} ${channel.name}`} channel={channel} />
          ))}
        </div>
      </details>
      <Said title="Notices" lines={result.notices} />
    </div>
  );
}

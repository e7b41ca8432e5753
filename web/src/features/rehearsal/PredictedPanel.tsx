/** On the page of a run that was rehearsed or looked ahead of before it began: predicted against real. */
import type { Run } from "../../api/types";
import { useStore, useView } from "../../store/context";
import { Panel } from "../../ui/Panel";
import { Icon } from "../../ui/theme/Icon";
import { usePreferences } from "../../units/preferences";
import { clock, duration } from "../../units/units";
import { placedIn, usePrediction } from "../plots/prediction";
import { againstOf, oddsAgainst, type Against } from "./against";
import { useForeseen } from "./Predicted";
import { caseInForce } from "./prediction";
import styles from "./Rehearse.module.css";
import { CASE_WORDS } from "./words";

const percent = (part: number): string => `${100 * part}%`;

function Row({ row: { title, unit, predicted, real, within, places } }: { readonly row: Against }) {
  return (
    <li className={`${styles.measure} ${styles.against}`}>
      <div className={styles.caseHead}>
        <span>{unit === "" ? title : `${title} [${unit}]`}</span>
        <strong data-within={within ?? undefined}>
          {real}
          {within !== null && <Icon icon={within ? "check" : "warning"} size={10} />}
          {within !== null && <span className="visually-hidden">{within ? ", as predicted" : ", outside of what was predicted"}</span>}
        </strong>
      </div>
      <div className={styles.range}>
        <span>predicted</span>
        <div className={styles.track} aria-hidden="true">
          <i style={{ left: percent(places.low), width: percent(Math.max(0.005, places.high - places.low)) }} />
          <b style={{ left: percent(places.median) }} />
          {places.real !== null && <em style={{ left: percent(places.real) }} />}
        </div>
        <span>{predicted}</span>
      </div>
    </li>
  );
}

/** Stands within the stored run. */
export function PredictedPanel({ run }: { readonly run: Run }) {
  const { angles } = usePreferences();
  const { series } = useStore();
  const result = useForeseen(run);
  const prediction = usePrediction();
  // The curves come after the page; what is known of them by then is read again.
  useView((view) => view.snapshot?.tick ?? null);
  if (result === null) return null;
  const placed = placedIn(prediction, series, series.at("time", series.length - 1) || 0);
  const name = caseInForce(result, run.config);
  const rows = run.outcome === null ? [] : againstOf(result, name, run.outcome, series, result.time + (placed?.shift ?? 0), angles);
  const later = placed !== null && placed.shift >= 0.1 ? ` The sequence began ${duration(placed.shift)} later: the target had turned on by then.` : "";
  const odds = run.outcome === null ? "It has not ended yet." : `Odds of what came: ${oddsAgainst(result, name, run.outcome)}.`;
  return (
    <Panel title="Predicted and real">
      <div className={styles.stored}>
        <p>{`Foreseen at ${clock(result.time)} by ${result.as_it_is.futures} futures, ${CASE_WORDS[name].toLowerCase()}. ${odds}${later}`}</p>
        {rows.length > 0 && (
          <ul className={styles.bands} aria-label="Real, and predicted: median, 5 to 95 %">
            {rows.map((row) => (
              <Row key={row.measure} row={row} />
            ))}
          </ul>
        )}
        <p>The plots have the predicted bands behind the curves.</p>
      </div>
    </Panel>
  );
}

/** This run: its touches while it flies, how it ended, and its log to take away. */
import { DownloadLink } from "../../ui/DownloadLink";
import { Panel } from "../../ui/Panel";
import { Term } from "../glossary/Term";
import { hashOf } from "../../store/route";
import { logAddress } from "../../api/service";
import type { Outcome } from "../../api/types";
import { useSnapshot, useView } from "../../store/context";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { classStyle } from "../glossary/class-style";
import { clock, fixed, MILLIMETRES } from "../../units/units";
import { verdictOf, type Verdict } from "./outcome";
import styles from "./RunPanel.module.css";
import { TouchTable } from "./TouchTable";

const ICONS: Readonly<Record<Verdict["tone"], IconName>> = { good: "check", fair: "warning", bad: "cross" };

function margin(outcome: Outcome): string {
  return outcome.cage_margin === null ? "none" : `${fixed(outcome.cage_margin * MILLIMETRES.factor, 1)} mm`;
}

export function Ending({ outcome }: { readonly outcome: Outcome }) {
  const verdict = verdictOf(outcome);
  const closed = outcome.closed_at === null ? "never" : clock(outcome.closed_at, 2);
  return (
    <section className={styles.ending} data-tone={verdict.tone} aria-label="Outcome" role="status">
      <h3 className={styles.headline}>
        <Icon icon={ICONS[verdict.tone]} size={18} /> {verdict.headline}
      </h3>
      <p>
        {verdict.meaning} <Term term={outcome.outcome}>How it is judged</Term>
      </p>
      <dl className={styles.figures}>
        <div>
          <dt>
            <Term term="peak_tip_force_to_closure">Peak to closure</Term>
          </dt>
          <dd>{fixed(outcome.peak_tip_force_to_closure, 3)} N</dd>
        </div>
        <div>
          <dt>
            <Term term="peak_tip_force">Peak to locked arms</Term>
          </dt>
          <dd>{fixed(outcome.peak_tip_force, 3)} N</dd>
        </div>
        <div>
          <dt>
            <Term term="cage_margin">Cage margin</Term>
          </dt>
          <dd>{margin(outcome)}</dd>
        </div>
        <div>
          <dt>
            <Term term="closed_at">Closed at</Term>
          </dt>
          <dd>{closed}</dd>
        </div>
      </dl>
      {outcome.at_first_closure !== outcome.at_locked_arms && (
        <p className={styles.rule}>
          <Term term="at_first_closure">Paper&apos;s verdict</Term>: <Term term={outcome.at_first_closure}>{classStyle(outcome.at_first_closure).words}</Term>.
        </p>
      )}
    </section>
  );
}

export function RunPanel() {
  const outcome = useSnapshot((snapshot) => snapshot.outcome);
  const touches = useView((view) => view.touches);
  const run = useSnapshot((snapshot) => snapshot.run_id);
  const recorded = useSnapshot((snapshot) => snapshot.tick > 0) ?? false;
  return (
    <Panel title={outcome ? "Outcome" : "This run"} dated="robot">
      {outcome && <Ending outcome={outcome} />}
      <TouchTable touches={touches} />
      {run !== null && recorded && (
        <div className={styles.downloads}>
          <a href={hashOf({ page: "runs", item: run })}>Open in Runs</a>
          <span />
          <DownloadLink href={logAddress(run, "csv")} format="CSV" what="the log of this run" />
          <DownloadLink href={logAddress(run, "parquet")} format="Parquet" what="the log of this run" />
        </div>
      )}
    </Panel>
  );
}

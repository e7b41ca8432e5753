/** What would change, beside what is in force; applied together or not at all. */
import { Button } from "@mantine/core";
import type { ReactNode } from "react";
import { usePreferences } from "../../units/preferences";
import type { Refusal } from "../../api/refusal";
import { Icon } from "../../ui/theme/Icon";
import { shown } from "../../units/units";
import { ARMED_STYLE, SecondsLeft } from "../commands/SecondsLeft";
import { useReasonAgainstCommanding } from "../control/control";
import type { ArmedChanges } from "./arming";
import { fieldText, type Change } from "./draft";
import styles from "./StagedChanges.module.css";

interface StagedChangesProps {
  readonly changes: readonly Change[];
  /** How many fields hold what cannot be sent. */
  readonly unsound: number;
  readonly touched: boolean;
  /** What else may be done with them. */
  readonly beside: ReactNode;
  readonly refusal: Refusal | null;
  readonly applying: boolean;
  /** Set while the next press applies them with a robot. */
  readonly armed: ArmedChanges | null;
  readonly apply: () => void;
  readonly discard: () => void;
}

function Difference({ change: { parameter, from, to } }: { readonly change: Change }) {
  const { angles } = usePreferences();
  return (
    <li>
      <span className={styles.name} title={parameter.path}>{parameter.title}</span>
      <span className={styles.from}>{fieldText(parameter, from, angles)}</span>
      <Icon icon="follow" size={11} />
      <span className="visually-hidden">becomes</span>
      <strong>{fieldText(parameter, to, angles)}</strong>
      <span className={styles.unit}>{shown(parameter.unit, angles).unit}</span>
    </li>
  );
}

/** What was applied last, and the press that takes it back: nothing is asked, and nothing jumps. */
export function UndoLine({ back, refusal, undo }: { readonly back: readonly Change[]; readonly refusal: Refusal | null; readonly undo: () => void }) {
  const byWho = useReasonAgainstCommanding();
  return (
    <section className={styles.staged} aria-label="Applied changes">
      <ul className={styles.list}>
        {back.map((change) => (
          <Difference key={change.parameter.path} change={{ ...change, from: change.to, to: change.from }} />
        ))}
      </ul>
      {refusal !== null && <p className={styles.refusal} role="alert"><Icon icon="warning" /> <span>{`${refusal.message} ${refusal.tip}`}</span></p>}
      <div className={styles.buttons}>
        <span role="status">Applied.</span>
        <Button disabled={byWho !== null} title={byWho ?? "Take the last Apply back"} onClick={undo}>Undo</Button>
      </div>
    </section>
  );
}

export function StagedChanges({ changes, unsound, touched, beside, refusal, applying, armed, apply, discard }: StagedChangesProps) {
  const byWho = useReasonAgainstCommanding();
  if (!touched) return null;
  return (
    <section className={styles.staged} aria-label="Staged changes">
      <details className={styles.differences}>
        <summary className={styles.count}>
          <h3>{`${changes.length} ${changes.length === 1 ? "change" : "changes"} staged`}</h3>
          {unsound > 0 && <span>{`${unsound} to correct`}</span>}
        </summary>
        <ul className={styles.list}>
          {changes.map((change) => (
            <Difference key={change.parameter.path} change={change} />
          ))}
        </ul>
      </details>
      {refusal !== null && (
        <p className={styles.refusal} role="alert">
          <Icon icon="warning" /> <span>{`${refusal.message} ${refusal.tip && `(${refusal.tip})`}`}</span>
        </p>
      )}
      {armed !== null && (
        <p className={styles.refusal} role="status">
          <Icon icon="warning" /> <span>A new mission takes over the robot in its current pose. Press again to confirm.</span>
        </p>
      )}
      <div className={styles.buttons}>
        <Button onClick={discard}>Discard</Button>
        {beside}
        <Button
          variant="filled"
          {...(armed && ARMED_STYLE)}
          disabled={unsound > 0 || changes.length === 0 || byWho !== null}
          title={byWho ?? undefined}
          loading={applying}
          onClick={apply}
        >
          {armed === null ? "Apply" : <SecondsLeft until={armed.until} />}
        </Button>
      </div>
    </section>
  );
}

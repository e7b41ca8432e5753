/** The limits of every signal that is watched: in force, as chosen and by default. */
import { ActionIcon, Button, TextInput } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { chooseLimits, forgetLimits, readLimits } from "../../api/service";
import type { Limits, WatchedSignal } from "../../api/types";
import { useAction } from "../../api/use-action";
import { Panel } from "../../ui/Panel";
import { Icon } from "../../ui/theme/Icon";
import { readNumber } from "../../units/numbers";
import { usePreferences } from "../../units/preferences";
import { plain, shown, type AngleUnit } from "../../units/units";
import { useReasonByRole } from "../access/session";
import styles from "./AlarmsPage.module.css";
import { FIELDS, limitsOf, type Typed } from "./limits";

const LABELS = { watch: "Watch", warning: "Warning", critical: "Critical", hysteresis: "Hysteresis" } as const;

interface RowProps {
  readonly signal: WatchedSignal;
  readonly angles: AngleUnit;
  readonly disabledReason: string | null;
  readonly onSave: (signal: string, limits: Limits) => void;
  readonly onReset: (signal: string) => void;
}

function Row({ signal, angles, disabledReason, onSave, onReset }: RowProps) {
  const [typed, setTyped] = useState<Typed>({});
  const { factor, unit } = shown(signal.unit, angles);
  const textOf = (field: keyof Limits): string => {
    const value = signal.limits[field];
    return typed[field] ?? (value === null || value === undefined ? "" : plain(value * factor));
  };
  const read = limitsOf(signal.limits, typed, factor);
  const edited = Object.keys(typed).length > 0;
  const fault = "fault" in read ? read.fault : null;
  const chosen = signal.chosen_by !== null;
  return (
    <tr data-edited={edited || undefined}>
      <th scope="row" title={`${signal.description}. ${chosen ? `Chosen by ${signal.chosen_by ?? ""}` : "Default limits"}`}>
        {signal.title}
        <small>{`${signal.side}, ${unit}`}</small>
      </th>
      {FIELDS.map((field) => (
        <td key={field}>
          <TextInput
            aria-label={`${signal.title}: ${LABELS[field].toLowerCase()}`}
            placeholder="none"
            inputMode="decimal"
            disabled={disabledReason !== null}
            title={disabledReason ?? undefined}
            error={typed[field] !== undefined && typed[field].trim() !== "" && "error" in readNumber(typed[field])}
            value={textOf(field)}
            onChange={(event) => { setTyped({ ...typed, [field]: event.currentTarget.value }); }}
          />
        </td>
      ))}
      <td className={styles.saving}>
        {edited && (
          <>
            <Button size="compact-xs" variant="filled" disabled={fault !== null} title={fault ?? undefined} onClick={() => { if (!("fault" in read)) onSave(signal.name, read); setTyped({}); }}>Save</Button>
            <Button size="compact-xs" variant="subtle" onClick={() => { setTyped({}); }}>Cancel</Button>
          </>
        )}
        {!edited && chosen && (
          <ActionIcon size={22} aria-label={`${signal.title}: back to the default limits`} title="Back to the default limits" disabled={disabledReason !== null} onClick={() => { onReset(signal.name); }}>
            <Icon icon="reset" size={11} />
          </ActionIcon>
        )}
      </td>
    </tr>
  );
}

export function LimitTable({ shown: isShown }: { readonly shown: boolean }) {
  const client = useQueryClient();
  const { angles } = usePreferences();
  const { data } = useQuery({ queryKey: ["limits"], queryFn: readLimits, enabled: isShown });
  const { runAction, refusal } = useAction();
  const disabledReason = useReasonByRole("operator");
  const change = (work: () => Promise<unknown>): void => {
    void runAction(async () => {
      await work();
      await client.invalidateQueries({ queryKey: ["limits"] });
    });
  };
  return (
    <Panel title="Limits" grow tall>
      {refusal !== null && <p className={styles.refusal} role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
      <div className={styles.scroll} role="region" aria-label="Limits of the signals" tabIndex={0}>
        <table className={styles.limits}>
          <thead>
            <tr>
              <th scope="col">Signal</th>
              {FIELDS.map((field) => <th key={field} scope="col">{LABELS[field]}</th>)}
              <td />
            </tr>
          </thead>
          <tbody>
            {(data ?? []).map((signal) => (
              <Row key={`${signal.name} ${signal.chosen_at ?? ""}`} signal={signal} angles={angles} disabledReason={disabledReason} onSave={(name, limits) => { change(() => chooseLimits(name, limits)); }} onReset={(name) => { change(() => forgetLimits(name)); }} />
            ))}
          </tbody>
        </table>
      </div>
      <p className={styles.hint}>The same for everyone. Watch is shown; warning and critical are to be acknowledged. A limit is left once the value is back within it by the hysteresis. Empty: no such level.</p>
    </Panel>
  );
}

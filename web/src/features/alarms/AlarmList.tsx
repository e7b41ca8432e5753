/** The list of alarms, the most urgent first, with what can be done about each. */
import { Button } from "@mantine/core";
import { useAction, type RunAction } from "../../api/use-action";
import { acknowledgeAlarm, shelveAlarm, unshelveAlarm } from "../../api/service";
import type { Alarm } from "../../api/types";
import { useView } from "../../store/context";
import { hashOf } from "../../store/route";
import { Choice } from "../../ui/Choice";
import { Panel } from "../../ui/Panel";
import { Icon } from "../../ui/theme/Icon";
import { usePreferences } from "../../units/preferences";
import { clock } from "../../units/units";
import { RoleButton } from "../access/RoleButton";
import { useReasonByRole } from "../access/session";
import styles from "./AlarmsPage.module.css";
import { beyondWords, inOrder, LEVEL_ICONS, speaks } from "./alarms";

/** Minutes for which an alarm may be shelved. */
const SHELVES = [
  { value: "", label: "Shelve" },
  { value: "5", label: "for 5 min" },
  { value: "30", label: "for 30 min" },
  { value: "120", label: "for 2 h" },
  { value: "480", label: "for 8 h" },
];

const timeOf = (at: string): string => new Date(at).toLocaleTimeString(undefined, { timeStyle: "medium" });

function Shelf({ alarm, runAction }: { readonly alarm: Alarm; readonly runAction: RunAction }) {
  const disabledReason = useReasonByRole("operator");
  if (alarm.shelved_until !== null) {
    return <RoleButton needs="operator" size="compact-xs" aria-label={`Unshelve: ${alarm.title}`} onClick={() => void runAction(() => unshelveAlarm(alarm.key))}>Unshelve</RoleButton>;
  }
  return <Choice aria-label={`Shelve: ${alarm.title}`} disabled={disabledReason !== null} title={disabledReason ?? "It says nothing for a while, and stays in the list"} value="" data={SHELVES} onChange={(minutes) => { if (minutes !== "") void runAction(() => shelveAlarm(alarm.key, Number(minutes))); }} />;
}

/** Who did what about it. */
function stateWords({ acknowledged_by: seen, shelved_by: shelved, shelved_until: until, active }: Alarm): string {
  const parts = [active ? "" : "over", seen === null ? "" : `seen by ${seen}`, until === null ? "" : `shelved by ${shelved ?? ""} until ${timeOf(until)}`];
  return parts.filter(Boolean).join(", ");
}

function Entry({ alarm, runAction }: { readonly alarm: Alarm; readonly runAction: RunAction }) {
  const { angles } = usePreferences();
  return (
    <li className={styles.alarm} data-level={alarm.level} data-speaks={speaks(alarm) || undefined}>
      <Icon icon={LEVEL_ICONS[alarm.level]} size={18} />
      <div>
        <h3>
          {alarm.title} <span>{alarm.level}</span>
        </h3>
        <p>{beyondWords(alarm, angles)}</p>
        {alarm.tip !== "" && <p className={styles.dim}>Tip: {alarm.tip}</p>}
        <p className={styles.dim}>
          {`since ${timeOf(alarm.raised_at)}, `}
          <a href={`${hashOf({ page: "runs", item: alarm.run_id })}?t=${alarm.since.toFixed(3)}`} title={`Run ${alarm.run_id} at that moment`}>{`mission time ${clock(alarm.since, 1)}`}</a>
          {stateWords(alarm) !== "" && `; ${stateWords(alarm)}`}
        </p>
      </div>
      <div className={styles.actions}>
        {alarm.acknowledged_at === null && (
          <RoleButton needs="operator" size="compact-xs" variant={speaks(alarm) ? "filled" : "default"} aria-label={`Acknowledge: ${alarm.title}`} onClick={() => void runAction(() => acknowledgeAlarm(alarm.key))}>
            Acknowledge
          </RoleButton>
        )}
        <Shelf alarm={alarm} runAction={runAction} />
      </div>
    </li>
  );
}

export function AlarmList() {
  const alarms = inOrder(useView((view) => view.alarms));
  const { runAction, refusal } = useAction();
  const unseen = alarms.filter(({ acknowledged_at: seen }) => seen === null);
  const disabledReason = useReasonByRole("operator");
  const all = (
    <Button size="compact-xs" disabled={unseen.length === 0 || disabledReason !== null} title={disabledReason ?? undefined} onClick={() => void runAction(() => acknowledgeAlarm(null))}>
      Acknowledge all
    </Button>
  );
  return (
    <Panel title={alarms.length === 1 ? "1 alarm" : `${alarms.length} alarms`} grow dated="service" aside={all}>
      {refusal !== null && <p className={styles.refusal} role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
      <ul className={styles.list} tabIndex={0} aria-label="Alarms">
        {alarms.length === 0 && <li className={styles.none}>Nothing is beyond its limits, and there are no problems.</li>}
        {alarms.map((alarm) => (
          <Entry key={alarm.key} alarm={alarm} runAction={runAction} />
        ))}
      </ul>
    </Panel>
  );
}

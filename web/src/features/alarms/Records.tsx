/** What happened to alarms, and what people tell the next shift. */
import { Button, Textarea } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { noteShift, readAlarmHistory, readShiftLog } from "../../api/service";
import type { AlarmRecord, ShiftEntry } from "../../api/types";
import { useAction } from "../../api/use-action";
import { hashOf } from "../../store/route";
import { csvCell } from "../../ui/export/csv";
import { saveFile } from "../../ui/export/save-file";
import { Panel } from "../../ui/Panel";
import { useKeptJson } from "../../ui/use-kept-json";
import { usePreferences } from "../../units/preferences";
import { clock } from "../../units/units";
import { RoleButton } from "../access/RoleButton";
import styles from "./AlarmsPage.module.css";
import { valueWords } from "./alarms";

const PERIOD = 3000;

/** Today the time, else the day, too. */
function momentOf(at: string): string {
  const moment = new Date(at);
  const today = moment.toDateString() === new Date().toDateString();
  return today ? moment.toLocaleTimeString(undefined, { timeStyle: "medium" }) : moment.toLocaleString(undefined, { dateStyle: "short", timeStyle: "medium" });
}

function saveTable(rows: readonly (readonly string[])[], name: string): void {
  const text = rows.map((row) => row.map(csvCell).join(",")).join("\r\n");
  saveFile(new Blob([text, "\r\n"], { type: "text/csv" }), name);
}

const Run = ({ run_id: run, time }: Pick<AlarmRecord, "run_id" | "time">) => (
  <a href={`${hashOf({ page: "runs", item: run })}?t=${time.toFixed(3)}`} title={`Run ${run} at that moment`}>{clock(time, 1)}</a>
);

export function AlarmHistory({ shown }: { readonly shown: boolean }) {
  const { angles } = usePreferences();
  const { data = [] } = useQuery({ queryKey: ["alarm-history"], queryFn: readAlarmHistory, enabled: shown, refetchInterval: PERIOD });
  const save = (): void => {
    saveTable([["at", "happening", "alarm", "level", "value", "unit", "run", "time", "who"], ...data.map((each) => [each.at, each.happening, each.title, each.level, String(each.value ?? ""), each.unit, each.run_id, String(each.time), each.who ?? ""])], "becalm-alarms.csv");
  };
  return (
    <Panel title="History of alarms" grow aside={<Button size="compact-xs" disabled={data.length === 0} onClick={save}>Export CSV</Button>}>
      <div className={styles.scroll} role="region" aria-label="Records of alarms" tabIndex={0}>
        <table className={styles.records}>
          <tbody>
            {data.map((each) => (
              <tr key={`${each.at} ${each.key} ${each.happening}`} data-level={each.happening === "raised" ? each.level : undefined}>
                <td>{momentOf(each.at)}</td>
                <td>{each.who === null ? each.happening : `${each.happening} by ${each.who}`}</td>
                <th scope="row">{`${each.title}, ${each.level}`}</th>
                <td>{valueWords(each.value, each.unit, angles)}</td>
                <td><Run run_id={each.run_id} time={each.time} /></td>
              </tr>
            ))}
          </tbody>
        </table>
        {data.length === 0 && <p className={styles.hint}>No alarm yet.</p>}
      </div>
    </Panel>
  );
}

function Entry({ entry }: { readonly entry: ShiftEntry }) {
  return (
    <li>
      <p>{entry.text}</p>
      <small>
        {`${entry.who}, ${momentOf(entry.at)}`}
        {entry.run_id !== "" && <>, <Run run_id={entry.run_id} time={entry.time} /></>}
      </small>
    </li>
  );
}

const LONGEST = 2000;

export function ShiftLog({ shown }: { readonly shown: boolean }) {
  const client = useQueryClient();
  const { data = [] } = useQuery({ queryKey: ["shift-log"], queryFn: readShiftLog, enabled: shown, refetchInterval: PERIOD });
  const [text, setText] = useKeptJson("becalm-shift-draft", (kept) => (typeof kept === "string" ? kept.slice(0, LONGEST) : ""));
  const [saved, setSaved] = useState(false);
  const { runAction, refusal, waiting } = useAction();
  const note = () =>
    runAction(async () => {
      await noteShift(text.trim());
      setText("");
      setSaved(true);
      await client.invalidateQueries({ queryKey: ["shift-log"] });
    });
  const save = (): void => {
    saveTable([["at", "who", "text", "run", "time"], ...data.map(({ at, who, text: words, run_id: run, time }) => [at, who, words, run, String(time)])], "becalm-shift-log.csv");
  };
  return (
    <Panel title="Shift log" grow tall aside={<Button size="compact-xs" disabled={data.length === 0} onClick={save}>Export CSV</Button>}>
      <div className={styles.writing}>
        <Textarea aria-label="A note for the next shift" placeholder="What the next shift should know; kept with the run and the moment" size="xs" rows={2} maxLength={LONGEST} value={text} onChange={(event) => { setText(event.currentTarget.value); setSaved(false); }} />
        <RoleButton needs="operator" disabled={text.trim() === "" || waiting} onClick={() => void note()}>Note</RoleButton>
        {refusal !== null && <p className={styles.refusal} role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
        <span role="status" className="visually-hidden">{saved ? "Noted." : ""}</span>
      </div>
      <ul className={styles.entries} aria-label="Shift log" tabIndex={0}>
        {data.map((entry) => <Entry key={`${entry.at} ${entry.text}`} entry={entry} />)}
        {data.length === 0 && <li className={styles.none}>Nothing noted yet.</li>}
      </ul>
    </Panel>
  );
}

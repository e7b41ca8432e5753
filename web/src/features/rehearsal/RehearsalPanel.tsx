/** Rehearsals of the live mission, or of a moment of a stored run: what is asked for, how far it is, what came out. */
import { ActionIcon, Button, Progress, TextInput } from "@mantine/core";
import { useState } from "react";
import { rehearsalAddress } from "../../api/service";
import { useAction } from "../../api/use-action";
import { methodWords } from "../../source/methods";
import { useSnapshot } from "../../store/context";
import { Choice } from "../../ui/Choice";
import { DownloadLink } from "../../ui/DownloadLink";
import { Panel } from "../../ui/Panel";
import { Icon } from "../../ui/theme/Icon";
import { clock } from "../../units/units";
import { useStaging } from "../parameters/staging";
import { MomentContext, RehearsalContext, useRehearsal, useRehearsalDesk, useStoredMoment, type StoredMoment } from "./context";
import { isFlying, RehearsalDesk, type Finished } from "./desk";
import { OpenFuture } from "./OpenFuture";
import { faultsOf, REQUESTS, usePlan, type Requested } from "./plan";
import styles from "./Rehearse.module.css";
import { RehearseButton } from "./RehearseButton";
import { Results } from "./Results";
import { Uncertainty, useUncertaintyFields } from "./Uncertainty";
import { requestWords, statusWords } from "./words";

export const REQUEST_LABELS: Readonly<Record<Requested, string>> = {
  next: "Next",
  capture: "Capture",
  cage: "Cage",
  direct_cage: "Direct caging",
  continue: "Under way",
};

function Form({ faults }: { readonly faults: ReadonlyMap<string, string> }) {
  const { plan, change } = usePlan();
  return (
    <div className={styles.form}>
      <Choice
        aria-label="Request to rehearse"
        title="Next: a capture, or what is under way where something is"
        value={plan.requested}
        data={REQUESTS.map((value) => ({ value, label: REQUEST_LABELS[value] }))}
        onChange={(value) => {
          change({ requested: REQUESTS.find((known) => known === value) ?? "next" });
        }}
      />
      <TextInput aria-label="Futures" inputMode="numeric" value={plan.futures} error={faults.has("futures")} title={faults.get("futures") ?? "Of each configuration: 100 give odds to 10 %, 1000 to 3 %"} onChange={(event) => { change({ futures: event.currentTarget.value }); }} />
      <RehearseButton />
    </div>
  );
}

function Trouble({ words, tip, tone }: { readonly words: string; readonly tip: string; readonly tone: "bad" | "fair" }) {
  return (
    <p className={styles.trouble} role="alert" data-tone={tone} tabIndex={0}>
      <Icon icon={tone === "bad" ? "cross" : "warning"} />
      <span>
        {words}
        {tip !== "" && <small>{tip}</small>}
      </span>
    </p>
  );
}

/** What is being flown, or what became of it; a line that is always there, so that nothing jumps. */
function StateLine() {
  const desk = useRehearsalDesk();
  const { runAction, refusal: cancelRefusal } = useAction();
  const asking = useRehearsal((view) => view.asking);
  const detail = useRehearsal((view) => view.detail);
  const refusal = useRehearsal((view) => view.refusal);
  const { changes } = useStaging();
  const flying = detail !== null && isFlying(detail);
  const ended = detail !== null && !flying && detail.status !== "finished";
  const moment = useStoredMoment();
  const from = moment === null ? "From the present state" : `From ${clock(moment.at)}`;
  const idle = changes.length === 0 ? `${from}, as it is.` : `${from}, as it is, against the ${changes.length === 1 ? "staged change" : `${changes.length} staged changes`}.`;
  return (
    <>
      <div className={styles.line}>
        {flying ? (
          <div className={styles.flying}>
            <span>{statusWords(detail)}</span>
            <Progress size={3} value={(100 * detail.progress.done) / Math.max(1, detail.progress.total)} aria-label="Progress of the rehearsal" />
          </div>
        ) : (
          <span role="status">{asking ? "Asking." : idle}</span>
        )}
        {flying && (
          <Button size="compact-xs" onClick={() => void runAction(() => desk.cancel())}>
            Cancel
          </Button>
        )}
      </div>
      {refusal !== null && <Trouble words={refusal.message} tip={refusal.tip} tone="bad" />}
      {cancelRefusal !== null && flying && <Trouble words={cancelRefusal.message} tip={cancelRefusal.tip} tone="bad" />}
      {ended && <Trouble words={statusWords(detail)} tip="" tone={detail.status === "failed" ? "bad" : "fair"} />}
    </>
  );
}

function Of({ finished: { detail, result, run } }: { readonly finished: Finished }) {
  const desk = useRehearsalDesk();
  const moment = useStoredMoment();
  const present = useSnapshot((snapshot) => snapshot.run_id);
  const what = `${requestWords(result.request)} from ${clock(result.time)} on, ${methodWords(result.method)}`;
  return (
    <div className={styles.of}>
      <p role="status">
        {`${what}: ${statusWords(detail)}.`}
        {moment === null && present !== null && present !== run && " Of a run that has ended."}
      </p>
      <ActionIcon size={20} aria-label="Dismiss the rehearsal" title="Dismiss the rehearsal" onClick={desk.dismiss}>
        <Icon icon="cross" size={10} />
      </ActionIcon>
    </div>
  );
}

export function RehearsalPanel({ title = "Rehearsal" }: { readonly title?: string }) {
  const { plan } = usePlan();
  const fields = useUncertaintyFields();
  const faults = faultsOf(plan, fields);
  const finished = useRehearsal((view) => view.finished);
  return (
    <div className={styles.place} data-result={finished !== null || undefined}>
      <Panel title={title} grow>
        <Form faults={faults} />
        <StateLine />
        <div className={styles.scroll} tabIndex={-1}>
          <Uncertainty fields={fields} faults={faults} />
          {finished !== null && (
            <div className={styles.result}>
              <Of finished={finished} />
              <Results result={finished.result} />
              <OpenFuture key={finished.detail.id} finished={finished} />
              <div className={styles.downloads}>
                <DownloadLink href={rehearsalAddress(finished.detail.id, "json")} format="JSON" what="the rehearsal" />
                <DownloadLink href={rehearsalAddress(finished.detail.id, "parquet")} format="Parquet" what="the futures" />
              </div>
            </div>
          )}
        </div>
      </Panel>
    </div>
  );
}

/** On the page of a stored run: futures from the moment that it shows. */
export function MomentRehearsal({ moment }: { readonly moment: StoredMoment }) {
  const [desk] = useState(RehearsalDesk.unseen);
  return (
    <RehearsalContext value={desk}>
      <MomentContext value={moment}>
        <RehearsalPanel title="Rehearse from this moment" />
      </MomentContext>
    </RehearsalContext>
  );
}

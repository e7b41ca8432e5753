/** The form that has an atlas flown around the present state. */
import { Button, Checkbox, TextInput } from "@mantine/core";
import { useState, useSyncExternalStore } from "react";
import { startAtlas } from "../../api/service";
import { useAction } from "../../api/use-action";
import { useConfiguration } from "../../store/configuration";
import { useSnapshot } from "../../store/context";
import { go, subscribe } from "../../store/route";
import { Choice } from "../../ui/Choice";
import { Panel } from "../../ui/Panel";
import { SuggestInput } from "../../ui/SuggestInput";
import { Icon } from "../../ui/theme/Icon";
import { clock, shown } from "../../units/units";
import { useReasonByRole } from "../access/session";
import { patchOf, valueAt } from "../parameters/draft";
import { useStaging } from "../parameters/staging";
import { REQUESTS, usePlan } from "../rehearsal/plan";
import { REQUEST_LABELS } from "../rehearsal/RehearsalPanel";
import { useUncertaintyFields } from "../rehearsal/Uncertainty";
import styles from "../studies/StudiesPage.module.css";
import own from "./Atlas.module.css";
import { axisFor, MOST_A_CELL, MOST_VALUES, mayBeAxis, readAtlasDraft, stateIn, usualPaths, type AtlasDraft, type Axes, type AxisDraft, type RecordedState } from "./request";

const AXIS_WORDS: Readonly<Record<Axes, string>> = { x: "Across", y: "Upwards" };

interface AxisProps {
  readonly name: Axes;
  readonly axis: AxisDraft;
  readonly faults: ReadonlyMap<string, string>;
  readonly change: (axis: AxisDraft) => void;
}

function AxisFields({ name, axis, faults, change }: AxisProps) {
  const { parameters, inForce } = useConfiguration();
  const paths = parameters.filter(mayBeAxis).map(({ path, description, unit }) => ({ value: path, label: `${description} [${unit}]` }));
  const unit = shown(parameters.find(({ path }) => path === axis.path)?.unit ?? "1", "rad").unit;
  const fault = ["path", "from", "to", "count"].map((field) => faults.get(`${name} ${field}`)).find((each) => each !== undefined);
  const number = (field: "from" | "to" | "count", label: string) => (
    <TextInput
      label={label}
      inputMode="decimal"
      value={axis[field]}
      error={faults.has(`${name} ${field}`)}
      onChange={(event) => {
        change({ ...axis, [field]: event.currentTarget.value });
      }}
    />
  );
  return (
    <fieldset className={styles.lines}>
      <legend>{AXIS_WORDS[name]}</legend>
      <SuggestInput
        aria-label={`${AXIS_WORDS[name]}, parameter`}
        placeholder="parameter"
        data={paths}
        value={axis.path}
        error={faults.has(`${name} path`)}
        onChange={(path) => {
          change(parameters.some((each) => each.path === path) ? axisFor(path, parameters, inForce?.config) : { ...axis, path });
        }}
      />
      <div className={own.range}>
        {number("from", unit === "" ? "From" : `From, ${unit}`)}
        {number("to", "To")}
        {number("count", `Values, ≤ ${MOST_VALUES}`)}
      </div>
      {fault !== undefined && <p className={own.fault}>{fault}</p>}
    </fieldset>
  );
}

/** What stands in the form; before anything was chosen, two parameters of the method about their present values. */
function useAtlasDraft(): readonly [AtlasDraft, (part: Partial<AtlasDraft>) => void] {
  const { parameters, inForce } = useConfiguration();
  const [edited, setEdited] = useState<Partial<AtlasDraft>>({});
  const method = valueAt(inForce?.config, "method");
  const [x, y] = usualPaths(parameters, typeof method === "string" ? method : "published");
  const draft: AtlasDraft = {
    x: axisFor(x, parameters, inForce?.config),
    y: axisFor(y, parameters, inForce?.config),
    requested: "next",
    futures: "3",
    staged: false,
    ...edited,
  };
  return [draft, (part) => { setEdited((old) => ({ ...old, ...part })); }];
}

/** The state that the next atlas begins in; another address than one that names it leaves it as it is. */
function useRecordedState(): readonly [RecordedState | null, () => void] {
  const hash = useSyncExternalStore(subscribe, () => location.hash);
  const [kept, setKept] = useState<RecordedState | null>(null);
  const named = stateIn(hash);
  const state = named ?? kept;
  if (named !== null && JSON.stringify(named) !== JSON.stringify(kept)) setKept(named);
  const leave = (): void => {
    setKept(null);
    if (named !== null) go("atlas");
  };
  return [state, leave];
}

function StateLine({ state, leave }: { readonly state: RecordedState | null; readonly leave: () => void }) {
  if (state === null) return <p className={styles.estimate}>From the present state of the live mission; nothing moves.</p>;
  return (
    <div className={own.state}>
      <p className={styles.estimate}>{`From run …${state.run.slice(-6)} at ${clock(state.at)}; nothing moves.`}</p>
      <Button size="compact-xs" onClick={leave}>
        From now instead
      </Button>
    </div>
  );
}

export function NewAtlas({ onStarted }: { readonly onStarted: (id: string) => void }) {
  const { parameters } = useConfiguration();
  const { changes } = useStaging();
  const { plan } = usePlan();
  const fields = useUncertaintyFields();
  const phase = useSnapshot((snapshot) => snapshot.phase);
  const byRole = useReasonByRole("operator");
  const { runAction, waiting, refusal } = useAction();
  const [draft, change] = useAtlasDraft();
  const [state, leave] = useRecordedState();
  const { request, faults } = readAtlasDraft(draft, { parameters, plan, fields, phase, state, changes: patchOf(changes) });
  const unsure = Object.keys(plan.uncertainty).length;
  return (
    <Panel title="New atlas">
      <div className={styles.form}>
        <AxisFields name="x" axis={draft.x} faults={faults} change={(x) => { change({ x }); }} />
        <AxisFields name="y" axis={draft.y} faults={faults} change={(y) => { change({ y }); }} />
        <div className={styles.pair}>
          <Choice label="Request" value={draft.requested} data={REQUESTS.map((value) => ({ value, label: REQUEST_LABELS[value] }))} onChange={(value) => { change({ requested: REQUESTS.find((known) => known === value) ?? "next" }); }} />
          <TextInput label={`Futures a cell, ≤ ${MOST_A_CELL}`} inputMode="numeric" value={draft.futures} error={faults.has("futures")} onChange={(event) => { change({ futures: event.currentTarget.value }); }} />
        </div>
        <Checkbox size="xs" label={`Around what is staged (${changes.length})`} checked={draft.staged} disabled={changes.length === 0} onChange={(event) => { change({ staged: event.currentTarget.checked }); }} />
        <StateLine state={state} leave={leave} />
        <p className={styles.estimate}>{`Uncertainty as in rehearsals: ${unsure === 0 ? "defaults" : `${unsure} edited`}.`}</p>
        {refusal !== null && (
          <div className={styles.trouble} role="alert">
            <Icon icon="error" /> <strong>{refusal.message}</strong> <span>{refusal.tip}</span>
          </div>
        )}
        <Button variant="filled" loading={waiting} disabled={request === null || byRole !== null} title={byRole ?? undefined} onClick={() => { if (request !== null) void runAction(async () => { onStarted((await startAtlas(request)).id); }); }}>
          Map
        </Button>
      </div>
    </Panel>
  );
}

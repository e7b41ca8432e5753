/** On the page of a run: which numbers explain it, and what may be done with them. */
import { Button, Checkbox, Progress, TextInput } from "@mantine/core";
import { skipToken, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { refusalIn } from "../../api/query-client";
import type { Refusal } from "../../api/refusal";
import { cancelFit, fitAddress, keepFit, readFit, readFittable, startFit } from "../../api/service";
import type { FitDetail, FittableParameter } from "../../api/types";
import { useAction } from "../../api/use-action";
import { DownloadLink } from "../../ui/DownloadLink";
import { Panel } from "../../ui/Panel";
import { useKeptJson } from "../../ui/use-kept-json";
import { RoleButton } from "../access/RoleButton";
import { askerOf, usePlan } from "../rehearsal/plan";
import styles from "./Fit.module.css";
import { FitResults } from "./FitResults";
import { OtherRuns } from "./OtherRuns";
import { isUnderWay, runsOf, statusWords, uncertaintyTexts, type Roles } from "./words";

/** Milliseconds between two looks at a fit. */
const LOOK_PERIOD = 400;

const NONE: readonly FittableParameter[] = [];

function Trouble({ refusal }: { readonly refusal: Refusal | null }) {
  return refusal === null ? null : <p className={styles.refused} role="alert">{`${refusal.message} ${refusal.tip}`}</p>;
}

function Choose({ parameters, chosen, choose }: { readonly parameters: readonly FittableParameter[]; readonly chosen: ReadonlySet<string>; readonly choose: (name: string) => void }) {
  return (
    <details className={styles.fold}>
      <summary>
        Parameters <span>{`${chosen.size} of ${parameters.length}`}</span>
      </summary>
      <div className={styles.names}>
        {parameters.map(({ name, description, unit }) => (
          <Checkbox key={name} size="xs" label={name} title={`${description} [${unit}]`} checked={chosen.has(name)} onChange={() => { choose(name); }} />
        ))}
      </div>
    </details>
  );
}

function UnderWay({ detail }: { readonly detail: FitDetail }) {
  const { runAction, refusal } = useAction();
  return (
    <div className={styles.way}>
      <span role="status">{statusWords(detail)}</span>
      <Button size="compact-xs" onClick={() => void runAction(() => cancelFit(detail.id))}>Cancel</Button>
      <Progress size={3} value={(100 * detail.progress.done) / Math.max(1, detail.progress.total)} aria-label="Progress of the fit" />
      <Trouble refusal={refusal} />
    </div>
  );
}

/** Keep as a preset, or as what rehearsals take for unsure. */
function Use({ detail, uncertainty }: { readonly detail: FitDetail; readonly uncertainty: Readonly<Record<string, number>> }) {
  const { plan, change } = usePlan();
  const { runAction, waiting, refusal } = useAction();
  const [name, setName] = useState("as fitted");
  const [said, setSaid] = useState("");
  const keep = (): void =>
    void runAction(async () => {
      await keepFit(detail.id, name);
      setSaid(`Kept as ${name}.`);
    });
  const use = (): void => {
    change({ uncertainty: { ...plan.uncertainty, ...uncertaintyTexts(uncertainty) } });
    setSaid("Rehearsals take these errors for what is not known.");
  };
  return (
    <div className={styles.use}>
      <TextInput aria-label="Name of the preset" size="xs" value={name} onChange={(event) => { setName(event.currentTarget.value); }} />
      <RoleButton needs="operator" size="compact-xs" disabled={waiting || name.trim() === ""} onClick={keep}>Keep as preset</RoleButton>
      <Button size="compact-xs" disabled={Object.keys(uncertainty).length === 0} onClick={use}>Use as the uncertainty model</Button>
      <p role="status">{said}</p>
      <Trouble refusal={refusal} />
    </div>
  );
}

function Found({ detail }: { readonly detail: FitDetail }) {
  if (detail.result === null) return isUnderWay(detail) ? null : <p className={styles.refused} role="alert">{`The fit has ${statusWords(detail)}`}</p>;
  return (
    <>
      <FitResults result={detail.result} />
      <Use detail={detail} uncertainty={detail.result.uncertainty} />
      <div className={styles.downloads}>
        <DownloadLink href={fitAddress(detail.id, "html")} format="HTML" what="the report of the fit" />
        <DownloadLink href={fitAddress(detail.id, "pdf")} format="PDF" what="the report of the fit" />
        <DownloadLink href={fitAddress(detail.id, "json")} format="JSON" what="the fit" />
      </div>
    </>
  );
}

/** The fit of this page, also after it was left and opened again; null without one, or once the service has forgotten it. */
function useFit(run: string): { readonly detail: FitDetail | undefined; readonly refusal: Refusal | null; readonly set: (id: string) => void } {
  const [id, setId] = useKeptJson<string | null>(`becalm-fit-${run}`, (kept) => (typeof kept === "string" ? kept : null), "tab");
  const { data, error } = useQuery({
    queryKey: ["fit", id],
    queryFn: id === null ? skipToken : () => readFit(id),
    refetchInterval: ({ state }) => (state.data !== undefined && isUnderWay(state.data) ? LOOK_PERIOD : false),
  });
  const refusal = refusalIn(error);
  return { detail: data, refusal: refusal?.status === 404 ? null : refusal, set: setId };
}

export function FitPanel({ run }: { readonly run: string }) {
  const parameters = useQuery({ queryKey: ["fittable"], queryFn: readFittable, staleTime: Infinity }).data ?? NONE;
  const [edited, setEdited] = useState<ReadonlySet<string> | null>(null);
  const [roles, setRoles] = useState<Roles>(new Map());
  const { detail, refusal: lost, set } = useFit(run);
  const { runAction, waiting, refusal } = useAction();
  const chosen = edited ?? new Set(parameters.filter(({ usual }) => usual).map(({ name }) => name));
  const choose = (name: string): void => {
    setEdited(new Set(chosen.has(name) ? [...chosen].filter((each) => each !== name) : [...chosen, name]));
  };
  const begin = (): void =>
    void runAction(async () => {
      const names = parameters.map(({ name }) => name).filter((name) => chosen.has(name));
      const begun = await startFit({ runs: [run, ...runsOf(roles, "fitted")], parameters: names, held_out: runsOf(roles, "held out"), asker: askerOf("fit") });
      set(begun.id);
    });
  const underWay = detail !== undefined && isUnderWay(detail);
  return (
    <Panel title="Fit">
      <div className={styles.fit}>
        <p>Finds the numbers of contact, servos, target and sensors that explain this run, by flying its recorded commands again.</p>
        <Choose parameters={parameters} chosen={chosen} choose={choose} />
        <OtherRuns run={run} roles={roles} choose={setRoles} />
        <RoleButton needs="operator" size="compact-xs" disabled={waiting || underWay || chosen.size === 0} onClick={begin}>Fit</RoleButton>
        <Trouble refusal={refusal ?? lost} />
        {waiting && <p role="status">The runs are read.</p>}
        {underWay && <UnderWay detail={detail} />}
        {detail !== undefined && <Found key={detail.id} detail={detail} />}
      </div>
    </Panel>
  );
}

/** One of the futures as a run of the library, and its link as soon as it has been flown. */
import { Button, TextInput } from "@mantine/core";
import { useQuery, skipToken } from "@tanstack/react-query";
import { useState } from "react";
import type { Refusal } from "../../api/refusal";
import { readRun, runFuture } from "../../api/service";
import type { Run } from "../../api/types";
import { useAction } from "../../api/use-action";
import { isUnderWay } from "../../source/recorded-source";
import { hashOf } from "../../store/route";
import { Choice } from "../../ui/Choice";
import { readWhole } from "../../units/numbers";
import { RoleButton } from "../access/RoleButton";
import type { Finished } from "./desk";
import styles from "./Rehearse.module.css";
import { casesOf, CASE_WORDS, CASES, type CaseName } from "./words";

/** Milliseconds between two looks at a run that is flown. */
const LOOK_PERIOD = 700;

/** What became of the last one that was asked for. */
export function FutureRun({ run, refusal }: { readonly run: Run | null; readonly refusal: Refusal | null }) {
  const id = run?.id ?? null;
  const { data } = useQuery({
    queryKey: ["run", id],
    queryFn: id === null ? skipToken : () => readRun(id),
    refetchInterval: ({ state }) => (state.data === undefined || isUnderWay(state.data) ? LOOK_PERIOD : false),
  });
  if (refusal !== null) return <p className={styles.refused} role="alert">{`${refusal.message} ${refusal.tip}`}</p>;
  if (id === null) return null;
  const flown = data !== undefined && !isUnderWay(data);
  return (
    <p role="status">
      {flown ? <a href={hashOf({ page: "runs", item: id })}>{`Open run …${id.slice(-6)}`}</a> : `Run …${id.slice(-6)} is flown.`}
    </p>
  );
}

export function OpenFuture({ finished: { detail, result } }: { readonly finished: Finished }) {
  const { runAction, waiting, refusal } = useAction();
  const [run, setRun] = useState<Run | null>(null);
  const [chosen, setChosen] = useState<CaseName>("as_changed");
  const [typed, setTyped] = useState("0");
  const cases = casesOf(result);
  const { name, of } = cases.find((each) => each.name === chosen) ?? cases[0] ?? { name: "as_it_is" as const, of: result.as_it_is };
  const read = readWhole(typed);
  const number = "value" in read && read.value >= 0 && read.value < of.futures ? read.value : null;
  const open = (future: number): void =>
    void runAction(async () => {
      setRun(await runFuture(detail.id, future, name));
    });
  return (
    <section className={styles.section} aria-label="Futures as runs">
      <h3>Fly one of the futures as a run</h3>
      <div className={styles.open}>
        {cases.length > 1 && <Choice aria-label="Case" value={name} data={CASES.map((value) => ({ value, label: CASE_WORDS[value] }))} onChange={(value) => { setChosen(CASES.find((known) => known === value) ?? "as_it_is"); }} />}
        <RoleButton needs="operator" size="compact-xs" disabled={waiting} onClick={() => { open(of.most_likely); }}>{`Most likely, ${of.most_likely}`}</RoleButton>
        <RoleButton needs="operator" size="compact-xs" disabled={waiting} onClick={() => { open(of.worst); }}>{`Worst, ${of.worst}`}</RoleButton>
        <TextInput aria-label="Number of the future" w={52} inputMode="numeric" value={typed} error={number === null} title={`From 0 to ${of.futures - 1}`} onChange={(event) => { setTyped(event.currentTarget.value); }} />
        <Button size="compact-xs" disabled={waiting || number === null} onClick={() => { if (number !== null) open(number); }}>Fly</Button>
      </div>
      <FutureRun run={run} refusal={refusal} />
    </section>
  );
}

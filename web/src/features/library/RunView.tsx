/** One run of the library: how it ended, its plots and events, what people say of it, its log. */
import { ActionIcon, Button, Checkbox, Textarea, TextInput } from "@mantine/core";
import { useMemo, useState, useSyncExternalStore } from "react";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { DownloadLink } from "../../ui/DownloadLink";
import { Facts, type Fact } from "../../ui/Facts";
import { Panel } from "../../ui/Panel";
import { useKeptJson } from "../../ui/use-kept-json";
import { hashOf } from "../../store/route";
import { useAction, type RunAction } from "../../api/use-action";
import type { Refusal } from "../../api/refusal";
import { cancelRun, deleteRun, logAddress, remarkRun, runReportAddress } from "../../api/service";
import type { Run } from "../../api/types";
import { methodWords } from "../../source/methods";
import type { Playback } from "../../source/playback";
import { isUnderWay } from "../../source/recorded-source";
import type { Series } from "../../source/series";
import { StoreContext, useDataState } from "../../store/context";
import type { MissionStore } from "../../store/mission";
import { useMomentAddress } from "../../store/moment";
import { readNumber } from "../../units/numbers";
import { clock, duration, fixed, plain } from "../../units/units";
import { RoleButton } from "../access/RoleButton";
import { useReasonByRole } from "../access/session";
import { PrepareButton } from "../commands/PrepareButton";
import { EventLog } from "../events/EventLog";
import { ComparisonContext, type Alignment } from "../plots/compared";
import { FitPanel } from "../fit/FitPanel";
import { PlotPanel } from "../plots/PlotPanel";
import { StoredPrediction } from "../rehearsal/Predicted";
import { PredictedPanel } from "../rehearsal/PredictedPanel";
import { MomentRehearsal } from "../rehearsal/RehearsalPanel";
import { ReplayPanel } from "../replay/ReplayPanel";
import { Ending } from "../runs/RunPanel";
import { TouchTable } from "../runs/TouchTable";
import { ComparisonPanel } from "./ComparisonPanel";
import styles from "./LibraryPage.module.css";
import { showQuery, runHash, type LibraryQuery } from "./query";
import { useReadAgain, useStored } from "./use-library";
import { outcomeWords, verdictWords } from "./Verdict";
import { changeWords, configurationWords, damageWords, statusWords, tagsOf } from "./labels";

/** What became of it, at the top of the page: what stands below may be out of sight. */
const endingOf = (run: Run): string => (run.outcome === null ? statusWords(run) : `${statusWords(run)}: ${verdictWords(run)}`);

const LOGS = [
  ["mcap", "MCAP"],
  ["parquet", "Parquet"],
  ["csv", "CSV"],
] as const;

function Head({ run, query, runAction }: { readonly run: Run; readonly query: LibraryQuery; readonly runAction: RunAction }) {
  const deletingDisabledReason = useReasonByRole("admin");
  const editingDisabledReason = useReasonByRole("operator");
  const star = () => runAction(() => remarkRun(run.id, { starred: !run.starred }));
  const remove = () =>
    runAction(async () => {
      await deleteRun(run.id);
      showQuery(query);
    });
  return (
    <header className={styles.head}>
      <ActionIcon aria-label={run.starred ? "Unstar" : "Star this run"} aria-pressed={run.starred} disabled={editingDisabledReason !== null} title={editingDisabledReason ?? undefined} onClick={() => void star()}>
        {run.starred ? "★" : "☆"}
      </ActionIcon>
      <h2>{run.name === "" ? run.id : run.name}</h2>
      <span role="status">{isUnderWay(run) ? `${run.status}, ${duration(run.duration)} of mission time` : endingOf(run)}</span>
      <span className={styles.spring} />
      {run.ticks > 0 && LOGS.map(([format, label]) => <DownloadLink key={format} href={logAddress(run.id, format)} format={label} what="the log of this run" />)}
      {run.ticks > 0 && <DownloadLink href={runReportAddress(run.id, "html")} format="HTML" label="Report" what="the report of this run" />}
      {run.ticks > 0 && <DownloadLink href={runReportAddress(run.id, "pdf")} format="PDF" label="Report, PDF" what="the report of this run" />}
      {isUnderWay(run) && run.kind !== "live" && <RoleButton needs="operator" onClick={() => void runAction(() => cancelRun(run.id))}>Cancel</RoleButton>}
      {!isUnderWay(run) && <ConfirmButton label="Delete" question="Delete permanently?" disabledReason={deletingDisabledReason} onConfirm={() => void remove()} />}
    </header>
  );
}

function RunFacts({ run }: { readonly run: Run }) {
  const facts: readonly Fact[] = [
    ["Run", run.id],
    ...(run.earlier_outcomes.length === 0 ? [] : [["Earlier sequences", run.earlier_outcomes.map(outcomeWords).join("\n")] as const]),
    ["Configuration", configurationWords(run)],
    ["Changed", run.changes.length === 0 ? "none" : run.changes.map(changeWords).join("\n")],
    ["Method", methodWords(run.config.method)],
    ...(run.config.method === "published" ? [["Impedance m, d, k", Object.values(run.config.published.impedance).map(plain).join(", ")] as const] : []),
    ["Seed", String(run.seed)],
    ["Engine", run.engine],
    ["Recorded", `${run.ticks} ticks, ${fixed(run.size_bytes / 1e6, 1)} MB`],
    ["On disk", run.integrity ?? "being written"],
    ["Versions", Object.entries(run.versions).map(([name, version]) => `${name} ${version}`).join(", ")],
  ];
  return (
    <dl className={styles.facts}>
      <Facts facts={facts} />
      {run.parent !== null && (
        <div>
          <dt>Parent</dt>
          <dd>
            <a href={hashOf({ page: run.kind === "study" ? "studies" : "runs", item: run.parent })}>{run.parent}</a>
          </dd>
        </div>
      )}
      {run.note !== null && (
        <div>
          <dt>Service note</dt>
          <dd>{run.note}</dd>
        </div>
      )}
      {run.notices.length > 0 && (
        <div>
          <dt>Of another version</dt>
          <dd>{run.notices.join("\n")}</dd>
        </div>
      )}
    </dl>
  );
}

/** What of it cannot be read any more. */
function Damage({ events }: { readonly events: number | null }) {
  if (events === 0) return null;
  return (
    <p className={styles.refusal} role="alert">
      {`${damageWords(events)} The run cannot be forked or flown again; see the file events.jsonl in its folder.`}
    </p>
  );
}

const phaseAt = (series: Series, time: number): string => series.phaseSpans().findLast(({ start }) => start <= time)?.phase ?? "idle";

const NO_MOMENT = "The run has no such moment.";

/** Makes a moment of this run the live mission, paused, as a run of its own. */
function Fork({ run, playback, series }: { readonly run: Run; readonly playback: Playback; readonly series: Series }) {
  const [typed, setTyped] = useState<string | null>(null);
  const { time: shown } = useSyncExternalStore(playback.subscribe, playback.read);
  const time = typed ?? fixed(shown, 3);
  const read = readNumber(time);
  const moment = "value" in read ? read.value : null;
  const sound = moment !== null && moment > 0 && moment <= run.duration;
  const tick = Math.max(1, Math.round((moment ?? 0) / run.config.control.period));
  return (
    <Panel title="Fork from a moment">
      <div className={styles.writing}>
        <p className={styles.why}>Puts the live mission at this moment of the run, paused: change parameters, then run. It becomes a new run.</p>
        <TextInput aria-label="Moment of the run in seconds" placeholder={`seconds, up to ${fixed(run.duration, 3)}`} value={time} onChange={(event) => { setTyped(event.currentTarget.value); }} />
        <PrepareButton label="Fork here" request={{ command: "fork", run: run.id, tick }} disabledReason={sound ? null : NO_MOMENT} />
        {sound && (
          <a className={styles.atlas} href={`#/atlas?${new URLSearchParams({ run: run.id, at: String(moment), phase: phaseAt(series, moment) }).toString()}`}>
            Map two parameters from here
          </a>
        )}
      </div>
    </Panel>
  );
}

/** What could come of the moment that is shown. */
function Rehearsed({ run, playback, series }: { readonly run: Run; readonly playback: Playback; readonly series: Series }) {
  const time = useSyncExternalStore(playback.subscribe, () => {
    const shown = playback.read();
    return shown.playing ? Math.floor(2 * shown.time) / 2 : shown.time; // the panel need not follow every picture
  });
  return <MomentRehearsal moment={{ run: run.id, at: Math.min(time, run.duration), phase: phaseAt(series, time) }} />;
}

/** A moment that the replay goes to when it is pressed. */
function Moment({ time, playback }: { readonly time: number; readonly playback: Playback }) {
  return (
    <Button size="compact-xs" onClick={() => { playback.seek(time); }}>
      {`at ${clock(time)}`}
    </Button>
  );
}

const never = (): (() => void) => () => undefined;

/** The moment that a playback shows; null without one. */
const useMoment = (playback: Playback | null): number | null => useSyncExternalStore(playback?.subscribe ?? never, () => playback?.read().time ?? null);

function Notes({ run, runAction, playback }: { readonly run: Run; readonly runAction: RunAction; readonly playback: Playback | null }) {
  const [text, setText] = useKeptJson(`becalm-note-${run.id}`, (kept) => (typeof kept === "string" ? kept : ""), "tab");
  const [atMoment, setAtMoment] = useState(false);
  const time = useMoment(playback);
  const add = () =>
    runAction(async () => {
      await remarkRun(run.id, { notes: [...run.notes, { text: text.trim(), ...(atMoment && time !== null ? { time } : {}) }] as NonNullable<Parameters<typeof remarkRun>[1]["notes"]> });
      setText("");
    });
  const remove = (place: number) => runAction(() => remarkRun(run.id, { notes: run.notes.filter((_, at) => at !== place) }));
  return (
    <Panel title="Notes">
      <ul className={styles.notes}>
        {run.notes.map((note, place) => (
          <li key={`${note.at} ${note.text}`}>
            <p>{note.text}</p>
            <small>{note.who}</small>
            {typeof note.time === "number" && playback !== null && <Moment time={note.time} playback={playback} />}
            <RoleButton needs="operator" size="compact-xs" aria-label={`Remove the note: ${note.text}`} onClick={() => void remove(place)}>
              Remove
            </RoleButton>
          </li>
        ))}
      </ul>
      <div className={styles.writing}>
        <Textarea aria-label="A note on this run" placeholder="What is worth knowing about this run" size="xs" rows={2} value={text} onChange={(event) => { setText(event.currentTarget.value); }} />
        {time !== null && <Checkbox size="xs" label={`At the time shown, ${clock(time)}`} checked={atMoment} onChange={(event) => { setAtMoment(event.currentTarget.checked); }} />}
        <RoleButton needs="operator" disabled={text.trim() === ""} onClick={() => void add()}>
          Add note
        </RoleButton>
      </div>
    </Panel>
  );
}

function NameAndTags({ run, runAction }: { readonly run: Run; readonly runAction: RunAction }) {
  const [name, setName] = useState<string | null>(null);
  const [tags, setTags] = useState<string | null>(null);
  const disabledReason = useReasonByRole("operator");
  const keep = () =>
    runAction(async () => {
      await remarkRun(run.id, { ...(name !== null && { name }), ...(tags !== null && { tags: tagsOf(tags) }) });
      setName(null);
      setTags(null);
    });
  const forget = () => {
    setName(null);
    setTags(null);
  };
  const edited = name !== null || tags !== null;
  return (
    <Panel title="Name and tags">
      <div className={styles.writing}>
        <TextInput aria-label="Name of this run" placeholder="Name" maxLength={100} disabled={disabledReason !== null} value={name ?? run.name} onChange={(event) => { setName(event.currentTarget.value); }} />
        <TextInput aria-label="Tags of this run" placeholder="Tags, separated by commas" disabled={disabledReason !== null} value={tags ?? run.tags.join(", ")} onChange={(event) => { setTags(event.currentTarget.value); }} />
        {edited && (
          <div className={styles.keep}>
            <Button onClick={() => void keep()}>Save</Button>
            <Button variant="subtle" onClick={forget}>Cancel</Button>
          </div>
        )}
      </div>
    </Panel>
  );
}

/** What is stored of a run, and of the one that it is compared with. */
function Stored({ run, store, other, align }: { readonly run: Run; readonly store: MissionStore; readonly other: MissionStore | null; readonly align: Alignment }) {
  const comparison = useMemo(() => other && { store: other, align }, [other, align]);
  return (
    <StoreContext value={store}>
      <ComparisonContext value={comparison}>
        <StoredPrediction run={run}>
          <StoredPanels />
        </StoredPrediction>
      </ComparisonContext>
    </StoreContext>
  );
}

function StoredPanels() {
  return (
    <div className={styles.column} {...useDataState()}>
      <ReplayPanel />
      <div className={styles.plots}>
        <PlotPanel />
      </div>
      <EventLog />
    </div>
  );
}

const WITHOUT_REPLAY = { replay: null };

interface RunViewProps {
  readonly query: LibraryQuery;
  readonly run: Run;
  /** What it is compared with; null for nothing, or while that is read. */
  readonly other: Run | null;
  /** Why that cannot be read. */
  readonly missing: Refusal | null;
}

export function RunView({ run, other, missing, query }: RunViewProps) {
  const store = useStored(run);
  const compared = useStored(other, WITHOUT_REPLAY);
  const [align, setAlign] = useState<Alignment>("motion");
  const { runAction: asked, refusal } = useAction();
  const readAgain = useReadAgain();
  const runAction: RunAction = (work) => asked(() => work().then(readAgain));
  const playback = store?.source.playback ?? null;
  useMomentAddress(playback);
  return (
    <section className={styles.view} aria-label={`Run ${run.id}`}>
      <Head run={run} query={query} runAction={runAction} />
      {refusal !== null && <p className={styles.refusal} role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
      <Damage events={run.damaged_events} />
      <div className={styles.columns}>
        {store === null ? <p className={styles.hint}>Nothing has been recorded yet.</p> : <Stored run={run} store={store} other={compared} align={align} />}
        <div className={styles.side}>
          {missing !== null && <p className={styles.refusal} role="alert">{`${missing.message} ${missing.tip}`}</p>}
          {other !== null && <ComparisonPanel end={runHash(query, run.id)} one={run} other={other} align={align} onAlign={setAlign} />}
          <Panel title={run.outcome === null ? "About this run" : "Outcome"}>
            {run.outcome !== null && <Ending outcome={run.outcome} />}
            {run.outcome !== null && <TouchTable touches={run.outcome.contacts} />}
            <RunFacts run={run} />
          </Panel>
          {store !== null && (
            <StoreContext value={store}>
              <StoredPrediction run={run}>
                <PredictedPanel run={run} />
              </StoredPrediction>
            </StoreContext>
          )}
          {store !== null && !isUnderWay(run) && <FitPanel key={run.id} run={run.id} />}
          {store !== null && playback !== null && !isUnderWay(run) && <Fork run={run} playback={playback} series={store.series} />}
          {store !== null && playback !== null && !isUnderWay(run) && <Rehearsed key={`rehearsed ${run.id}`} run={run} playback={playback} series={store.series} />}
          <NameAndTags run={run} runAction={runAction} />
          <Notes run={run} runAction={runAction} playback={playback} />
        </div>
      </div>
    </section>
  );
}

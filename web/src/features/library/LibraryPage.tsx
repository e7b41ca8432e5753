/** The library: every run that was recorded, found, read, annotated, taken away. */
import { Button, Switch, TextInput } from "@mantine/core";
import { useState } from "react";
import { EmptyPage } from "../../app/EmptyPage";
import { Panel } from "../../app/Panel";
import { hashOf } from "../../app/route";
import type { RunsQuery, RunSummary } from "../../api/types";
import { Icon } from "../../theme/Icon";
import { fixed } from "../../units/units";
import { lookOf } from "../../theme/looks";
import { Choice } from "../../ui/Choice";
import styles from "./LibraryPage.module.css";
import { RunView } from "./RunView";
import { useLibrary, useRecording } from "./use-library";

const STATUSES = ["queued", "running", "finished", "failed", "cancelled"] as const;
const KINDS = ["live", "scripted", "study", "fork"] as const;
const OUTCOMES = [
  "caged_force_reduced",
  "caged_force_not_reduced",
  "caged_unplanned_contact",
  "ejection",
  "base_collision",
  "unresolved",
] as const;

const SORTS = [
  { value: "-started", label: "Newest first" },
  { value: "started", label: "Oldest first" },
  { value: "-peak_tip_force", label: "Hardest touch first" },
  { value: "peak_tip_force", label: "Softest first" },
  { value: "-duration", label: "Longest first" },
  { value: "-final_target_spin", label: "Fastest final spin first" },
  { value: "outcome", label: "By outcome" },
  { value: "configuration", label: "By configuration" },
  { value: "-size", label: "Largest log first" },
];

const choices = (all: string, values: readonly string[]) => [
  { value: "", label: all },
  ...values.map((value) => ({ value, label: value.replaceAll("_", " ") })),
];

/** The query with one wish in place of its own; an empty one is none. */
const withWish = (query: RunsQuery, name: keyof RunsQuery, value: string | boolean): RunsQuery => {
  const rest = Object.fromEntries(Object.entries(query).filter(([other]) => other !== name));
  return value === "" || value === false ? rest : { ...rest, [name]: value };
};

interface FilterProps {
  readonly query: RunsQuery;
  readonly onChange: (query: RunsQuery) => void;
}

function Filters({ query, onChange }: FilterProps) {
  const select = (name: "kind" | "status" | "outcome" | "sort", label: string, data: { value: string; label: string }[]) => (
    <Choice aria-label={label} value={query[name] ?? ""} data={data} onChange={(value) => { onChange(withWish(query, name, value)); }} />
  );
  return (
    <div className={styles.filters}>
      <TextInput
        aria-label="Search runs"
        placeholder="Search identifiers and notes"
        leftSection={<Icon sign="search" />}
        value={query.text ?? ""}
        onChange={(event) => { onChange(withWish(query, "text", event.currentTarget.value)); }}
      />
      <div className={styles.pair}>
        {select("kind", "Kind", choices("Every kind", KINDS))}
        {select("status", "Status", choices("Every status", STATUSES))}
      </div>
      <div className={styles.pair}>
        {select("outcome", "Outcome", choices("Every outcome", OUTCOMES))}
        {select("sort", "Order", SORTS)}
      </div>
      <Switch size="xs" label="Starred only" checked={query.starred === true} onChange={(event) => { onChange(withWish(query, "starred", event.currentTarget.checked)); }} />
    </div>
  );
}

const moment = (started: string): string =>
  new Date(started).toLocaleString(undefined, { dateStyle: "short", timeStyle: "medium" });

interface ItemProps {
  readonly run: RunSummary;
  /** The run that is open; empty for none. */
  readonly open: string;
  /** The run that it is compared with. */
  readonly other: string;
}

/** Puts a run beside the one that is open, or takes it away again. */
function Against({ run, open, other }: ItemProps) {
  const compared = run.id === other;
  return (
    <a className={styles.against} href={hashOf({ page: "runs", item: open, other: compared ? "" : run.id })} aria-current={compared ? "true" : undefined}>
      {compared ? "Compared" : "Compare"}
    </a>
  );
}

function Item({ run, open, other }: ItemProps) {
  const look = run.outcome === null ? null : lookOf(run.outcome.outcome);
  return (
    <li className={styles.entry}>
      <a className={styles.item} href={hashOf({ page: "runs", item: run.id })} aria-current={run.id === open ? "true" : undefined}>
        <span className={styles.mark} style={look === null ? undefined : { background: look.colour }} aria-hidden="true">
          {look?.letter ?? ""}
        </span>
        <span className={styles.words}>
          <strong>
            {run.starred && <span aria-label="starred">★ </span>}
            {run.outcome === null ? run.status : look?.words}
          </strong>
          <span>{`${run.configuration}${run.direct ? ", direct" : ""}`}</span>
          <span className={styles.when}>{`${moment(run.started)} · ${run.kind}${run.notes.length > 0 ? ` · ${run.notes.length} ${run.notes.length === 1 ? "note" : "notes"}` : ""}`}</span>
        </span>
        <span className={styles.peak}>{run.outcome === null ? "" : `${fixed(run.outcome.peak_tip_force, 2)} N`}</span>
      </a>
      {open !== "" && run.id !== open && run.ticks > 0 && <Against run={run} open={open} other={other} />}
    </li>
  );
}

export function LibraryPage({ item, other, shown }: { readonly item: string; readonly other: string; readonly shown: boolean }) {
  const [query, setQuery] = useState<RunsQuery>({ sort: "-started" });
  const [pages, setPages] = useState(1);
  const [edition, setEdition] = useState(0);
  const { runs, unreadable, more, refusal, read } = useLibrary(shown, query, pages, edition);
  const { recording, refusal: missing } = useRecording(shown ? item : "", edition);
  const { recording: compared, refusal: unlike } = useRecording(shown ? other : "", edition);
  const again = () => {
    setEdition((before) => before + 1);
  };
  return (
    <main className={styles.page} hidden={!shown}>
      <Panel title="Runs" grow aside={<span className={styles.count}>{`${runs.length}${more ? "+" : ""}`}</span>}>
        <Filters
          query={query}
          onChange={(next) => {
            setPages(1);
            setQuery(next);
          }}
        />
        {refusal !== null && <p className={styles.hint} role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
        {read && runs.length === 0 && <p className={styles.hint}>No run matches. Every capture that is flown, here or over REST, is kept as one.</p>}
        <ul className={styles.list} aria-label="Runs">
          {runs.map((run) => (
            <Item key={run.id} run={run} open={item} other={other} />
          ))}
        </ul>
        {more && <Button onClick={() => { setPages(pages + 1); }}>Show more</Button>}
        {unreadable.map((each) => (
          <p key={each.id} className={styles.hint}>{`${each.id} cannot be read: ${each.reason}`}</p>
        ))}
      </Panel>
      {recording === null ? (
        <EmptyPage
          label="No run chosen"
          title={missing === null ? (item === "" ? "Every run, every tick" : "Reading the run") : missing.message}
          words={missing?.tip ?? (item === "" ? "Choose a run: its plots with every touch, what happened in it, notes, and its log to take away." : "")}
        />
      ) : (
        <RunView key={recording.run.id} recording={recording} compared={compared} missing={unlike} onChange={again} />
      )}
    </main>
  );
}

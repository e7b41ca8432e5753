/** What is done with many runs at once, and what they say together. */
import { Button, TextInput } from "@mantine/core";
import { useState } from "react";
import { useAction } from "../../api/use-action";
import { deleteRun, listRuns, readRun, remarkRun } from "../../api/service";
import type { RunSummary } from "../../api/types";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { saveFile } from "../../ui/export/save-file";
import { Panel } from "../../ui/Panel";
import { Popup } from "../../ui/Popup";
import { useReasonByRole } from "../access/session";
import { forEachRun, resultWords } from "./bulk";
import { MOST_OVERLAID, overlayHash } from "./overlay-address";
import { requestOf, type LibraryQuery } from "./query";
import type { Selection } from "./selection";
import styles from "./SelectionPanel.module.css";
import { SelectionStatistics } from "./SelectionStatistics";
import { tagsOf } from "./labels";
import { logsAsZip, runsAsCsv, type LogFormat } from "./table-file";
import { useReadAgain } from "./use-library";

/** So many of what fits are selected at once. */
const MOST_SELECTED = 2000;
/** The service's page. */
const LISTED = 200;
/** The browser holds the archive in memory. */
const MOST_LOGS = 200;

/** All runs that a query finds, up to `MOST_SELECTED`. @throws Refusal */
async function allThatFit(query: LibraryQuery): Promise<RunSummary[]> {
  const runs: RunSummary[] = [];
  for (;;) {
    const page = await listRuns({ ...requestOf(query), limit: LISTED, offset: runs.length }, null);
    runs.push(...(page?.body.runs ?? []));
    if (page === null || page.body.runs.length < LISTED || runs.length >= MOST_SELECTED) return runs.slice(0, MOST_SELECTED);
  }
}

interface Work {
  /** Does it with every selected run, and says how far it is and what came of it. */
  readonly onEach: (what: string, work: (id: string) => Promise<unknown>) => Promise<void>;
  readonly onLogs: (format: LogFormat) => Promise<void>;
  readonly words: string;
}

function useWork({ selected, set }: Selection): Work {
  const [words, setWords] = useState("");
  const readAgain = useReadAgain();
  const { runAction, refusal } = useAction();
  const runs = [...selected.values()];
  const ids = runs.map(({ id }) => id);
  return {
    words: refusal === null ? words : `${refusal.message} ${refusal.tip}`,
    onEach: async (what, work) => {
      const result = await forEachRun(ids, work, (answered) => { setWords(`${answered} of ${ids.length} runs ${what}`); });
      setWords(resultWords(result, what));
      const refused = new Set(result.refused.map(({ id }) => id));
      if (what === "deleted") set(runs.filter(({ id }) => !refused.has(id)), false);
      await readAgain();
    },
    onLogs: (format) =>
      runAction(async () => {
        const recorded = runs.filter(({ ticks }) => ticks > 0).map(({ id }) => id);
        const archive = await logsAsZip(recorded, format, (read) => { setWords(`${read} of ${recorded.length} logs read`); });
        saveFile(archive, `becalm-${recorded.length}-runs-${format}.zip`);
        setWords(`${recorded.length} logs saved.`);
      }),
  };
}

function Tags({ onEach }: Pick<Work, "onEach">) {
  const [typed, setTyped] = useState("");
  const [opened, setOpened] = useState(false);
  const disabledReason = useReasonByRole("operator");
  const tags = tagsOf(typed);
  const change = (what: string, next: (before: readonly string[]) => string[]) => {
    setOpened(false);
    setTyped("");
    void onEach(what, async (id) => remarkRun(id, { tags: next((await readRun(id)).tags) }));
  };
  return (
    <Popup
      opened={opened}
      onChange={setOpened}
      target={
        <Button size="compact-xs" disabled={disabledReason !== null} title={disabledReason ?? undefined} onClick={() => { setOpened(!opened); }}>
          Tag
        </Button>
      }
    >
      <div className={styles.popup}>
        <TextInput aria-label="Tags for the selected runs" placeholder="Tags, separated by commas" value={typed} onChange={(event) => { setTyped(event.currentTarget.value); }} />
        <div className={styles.row}>
          <Button size="compact-xs" variant="filled" disabled={tags.length === 0} onClick={() => { change("tagged", (before) => [...new Set([...before, ...tags])]); }}>
            Add
          </Button>
          <Button size="compact-xs" disabled={tags.length === 0} onClick={() => { change("freed of it", (before) => before.filter((tag) => !tags.includes(tag))); }}>
            Remove
          </Button>
        </div>
      </div>
    </Popup>
  );
}

const FORMATS: readonly (readonly [LogFormat, string])[] = [["mcap", "MCAP"], ["parquet", "Parquet"], ["csv", "CSV"]];

function Export({ runs, onLogs }: { readonly runs: readonly RunSummary[]; readonly onLogs: Work["onLogs"] }) {
  const [opened, setOpened] = useState(false);
  const tooMany = runs.length > MOST_LOGS ? `At most ${MOST_LOGS} logs at once; the API has every one.` : undefined;
  const press = (work: () => void) => () => {
    setOpened(false);
    work();
  };
  return (
    <Popup opened={opened} onChange={setOpened} target={<Button size="compact-xs" onClick={() => { setOpened(!opened); }}>Export</Button>}>
      <div className={styles.popup}>
        <Button size="compact-xs" onClick={press(() => { saveFile(new Blob([runsAsCsv(runs)], { type: "text/csv" }), `becalm-${runs.length}-runs.csv`); })}>
          This table, CSV
        </Button>
        {FORMATS.map(([format, label]) => (
          <Button key={format} size="compact-xs" disabled={tooMany !== undefined} title={tooMany} onClick={press(() => void onLogs(format))}>
            {`Their logs, ${label} in one ZIP`}
          </Button>
        ))}
      </div>
    </Popup>
  );
}

/** Why so many cannot lie over one another; null if they can. */
function overlayReason(runs: readonly RunSummary[]): string | null {
  const recorded = runs.filter(({ ticks }) => ticks > 0).length;
  if (recorded === 0) return "Nothing has been recorded of them.";
  return recorded > MOST_OVERLAID ? `At most ${MOST_OVERLAID} runs can be told apart in one plot.` : null;
}

function SelectAll({ query, total, set }: { readonly query: LibraryQuery; readonly total: number; readonly set: Selection["set"] }) {
  const { runAction, waiting } = useAction();
  return (
    <Button size="compact-xs" disabled={waiting} onClick={() => void runAction(async () => { set(await allThatFit(query), true); })}>
      {total > MOST_SELECTED ? `Select the first ${MOST_SELECTED}` : `Select all ${total}`}
    </Button>
  );
}

interface SelectionPanelProps {
  readonly selection: Selection;
  readonly query: LibraryQuery;
  /** How many runs fit the query. */
  readonly total: number;
}

export function SelectionPanel({ selection, query, total }: SelectionPanelProps) {
  const { onEach, onLogs, words } = useWork(selection);
  const deletingDisabledReason = useReasonByRole("admin");
  const runs = [...selection.selected.values()];
  const overlaid = runs.filter(({ ticks }) => ticks > 0);
  const reason = overlayReason(runs);
  return (
    <Panel
      title={`${runs.length} ${runs.length === 1 ? "run" : "runs"} selected`}
      aside={
        <div className={styles.row} role="group" aria-label="Selected runs">
          <span role="status" className={styles.words}>{words}</span>
          {runs.length < total && <SelectAll query={query} total={total} set={selection.set} />}
          <Button size="compact-xs" disabled={reason !== null} title={reason ?? "Several runs in one plot: any quantity over time, or over another one"} onClick={() => { location.hash = overlayHash({ runs: overlaid.map(({ id }) => id) }); }}>
            Plot together
          </Button>
          <Tags onEach={onEach} />
          <Export runs={runs} onLogs={onLogs} />
          <ConfirmButton compact label="Delete" question={`Delete ${runs.length} permanently?`} disabledReason={deletingDisabledReason} onConfirm={() => void onEach("deleted", deleteRun)} />
          <Button size="compact-xs" variant="subtle" onClick={selection.clear}>Clear selection</Button>
        </div>
      }
    >
      <SelectionStatistics runs={runs} />
    </Panel>
  );
}

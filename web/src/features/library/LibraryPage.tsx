/** The library: every run that was recorded, found, read, annotated, taken away. */
import { ActionIcon } from "@mantine/core";
import { useMemo } from "react";
import { EmptyPage } from "../../ui/EmptyPage";
import { Panel } from "../../ui/Panel";
import { Icon } from "../../ui/theme/Icon";
import styles from "./LibraryPage.module.css";
import { showQuery, isFiltered, PAGE_SIZE, queryOf, runHash, useQueryAddress, type LibraryQuery } from "./query";
import { RunFilters } from "./RunFilters";
import { RunList } from "./RunList";
import { RunTable } from "./RunTable";
import { useSelection, type Selection } from "./selection";
import { SelectionPanel } from "./SelectionPanel";
import { RunView } from "./RunView";
import { useLibrary, useRun, type Library } from "./use-library";

interface PagesProps {
  readonly library: Library;
  readonly query: LibraryQuery;
  readonly item: string;
  readonly other: string;
}

/** "1–50 of 213", and the pages before and after. */
function Pages({ library: { runs, total, read }, query, item, other }: PagesProps) {
  const first = (query.page - 1) * PAGE_SIZE;
  const turn = (label: string, icon: "back" | "step", by: number, possible: boolean) => (
    <ActionIcon size="sm" aria-label={label} title={label} disabled={!possible} onClick={() => { showQuery({ ...query, page: query.page + by }, item, other); }}>
      <Icon icon={icon} size={12} />
    </ActionIcon>
  );
  return (
    <span className={styles.pages}>
      <span role="status">{!read ? "" : runs.length === 0 ? `none of ${total}` : `${first + 1}–${first + runs.length} of ${total}`}</span>
      {turn("Previous page", "back", -1, query.page > 1)}
      {turn("Next page", "step", 1, first + runs.length < total)}
    </span>
  );
}

function Nothing({ query }: { readonly query: LibraryQuery }) {
  const words = isFiltered(query) || query.page > 1 ? "No matching runs." : "No runs yet. Start a capture here or over REST.";
  return <p className={styles.hint}>{words}</p>;
}

function Found({ library, query, item, other, selection }: PagesProps & { readonly selection: Selection }) {
  const { runs, unreadable, refusal, read } = library;
  return (
    <Panel title="Runs" grow aside={<Pages library={library} query={query} item={item} other={other} />}>
      <RunFilters query={query} item={item} other={other} />
      {refusal !== null && <p className={styles.hint} role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
      {read && runs.length === 0 && <Nothing query={query} />}
      {item === "" ? <RunTable runs={runs} query={query} selection={selection} /> : <RunList runs={runs} query={query} open={item} other={other} />}
      {unreadable.map((each) => (
        <p key={each.id} className={styles.hint}>{`${each.id} cannot be read: ${each.reason}`}</p>
      ))}
    </Panel>
  );
}

export function LibraryPage({ item, other, shown }: { readonly item: string; readonly other: string; readonly shown: boolean }) {
  const address = useQueryAddress();
  const query = useMemo(() => queryOf(address), [address]);
  const library = useLibrary(shown, query);
  const selection = useSelection();
  const { run, refusal: missing } = useRun(shown ? item : "");
  const { run: compared, refusal: otherRefusal } = useRun(shown ? other : "");
  return (
    <main className={styles.page} hidden={!shown} data-open={item === "" ? undefined : true}>
      <div className={styles.found}>
        <Found library={library} query={query} item={item} other={other} selection={selection} />
        {item === "" && selection.selected.size > 0 && <SelectionPanel selection={selection} query={query} total={library.total} />}
      </div>
      {item !== "" && (
        <div className={styles.opened}>
          <a className={styles.all} href={runHash(query)}>
            All runs
          </a>
          {run === null ? (
            <EmptyPage label="No run selected" title={missing?.message ?? "Loading the run"} words={missing?.tip ?? ""} />
          ) : (
            <RunView key={run.id} run={run} other={compared} missing={otherRefusal} query={query} />
          )}
        </div>
      )}
    </main>
  );
}

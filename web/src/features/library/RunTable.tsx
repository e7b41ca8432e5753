/** Runs as a table: what each was flown with, and what came of it. */
import { Checkbox, Tooltip } from "@mantine/core";
import type { ReactNode } from "react";
import type { RunSummary } from "../../api/types";
import { meaningOf } from "../glossary/glossary";
import { classStyle } from "../glossary/class-style";
import { duration, fixed, MILLIMETRES } from "../../units/units";
import { showQuery, runHash, sortedBy, type LibraryQuery, type SortKey } from "./query";
import styles from "./RunTable.module.css";
import { extentOf, type Selection } from "./selection";
import { VerdictMark, verdictWords } from "./Verdict";
import { changesTitle, changeWords, configurationWords, momentWords } from "./labels";

interface Column {
  readonly key: SortKey;
  readonly label: string;
  /** What it is, in full. */
  readonly title: string;
  readonly number?: boolean;
  readonly cell: (run: RunSummary, query: LibraryQuery) => ReactNode;
}

const figure = (value: number | null | undefined, decimals: number, factor = 1): string =>
  value === null || value === undefined ? "" : fixed(value * factor, decimals);

function Tags({ run, query }: { readonly run: RunSummary; readonly query: LibraryQuery }) {
  return (
    <>
      {run.tags.map((tag) => (
        <a key={tag} className={styles.tag} href={runHash({ ...query, tag, page: 1 })} title={`Show only runs tagged ${tag}`}>
          {tag}
        </a>
      ))}
    </>
  );
}

function Changes({ run }: { readonly run: RunSummary }) {
  const [first, second, ...rest] = run.changes;
  if (first === undefined) return null;
  const words = [first, second].flatMap((change) => (change === undefined ? [] : [changeWords(change)])).join(", ");
  return <span title={changesTitle(run.changes)}>{rest.length === 0 ? words : `${words} and ${rest.length} more`}</span>;
}

const COLUMNS: readonly Column[] = [
  {
    key: "started",
    label: "Started",
    title: "When the run started",
    cell: (run, query) => (
      <a href={runHash(query, run.id)} title={run.id}>
        {run.starred && <span aria-label="starred">★ </span>}
        {momentWords(run.started, new Date())}
      </a>
    ),
  },
  {
    key: "name",
    label: "Name, tags",
    title: "Name and tags of the run",
    cell: (run, query) => (
      <span className={styles.called}>
        {run.name !== "" && <a href={runHash(query, run.id)}>{run.name}</a>}
        <Tags run={run} query={query} />
      </span>
    ),
  },
  { key: "kind", label: "Kind", title: "Live, scripted, from a study, or a fork", cell: ({ kind }) => kind },
  {
    key: "configuration",
    label: "Configuration",
    title: "The named configuration at its start, and the engine that simulated it",
    cell: (run) => `${configurationWords(run)}, ${run.engine}`,
  },
  { key: "changes", label: "Changed", title: "Parameters that differ from the named configuration", cell: (run) => <Changes run={run} /> },
  { key: "seed", label: "Seed", title: "simulation.seed", number: true, cell: ({ seed }) => seed },
  { key: "initial_spin", label: "Spin, rad/s", title: "Of the target at the start, as configured", number: true, cell: (run) => figure(run.initial_spin, 2) },
  { key: "peak_tip_force", label: "Peak, N", title: meaningOf("peak_tip_force") ?? "", number: true, cell: ({ outcome }) => figure(outcome?.peak_tip_force, 3) },
  {
    key: "cage_margin",
    label: "Margin, mm",
    title: meaningOf("cage_margin") ?? "",
    number: true,
    cell: ({ outcome }) => figure(outcome?.cage_margin, 1, MILLIMETRES.factor),
  },
  { key: "duration", label: "Duration", title: "Mission time recorded", number: true, cell: (run) => duration(run.duration) },
  {
    key: "outcome",
    label: "Verdict",
    title: meaningOf("at_locked_arms") ?? "",
    cell: (run) => (
      <span className={styles.verdict} title={run.outcome === null ? run.note ?? undefined : meaningOf(run.outcome.outcome) ?? undefined}>
        <VerdictMark run={run} /> {verdictWords(run)}
      </span>
    ),
  },
  {
    key: "at_first_closure",
    label: "Paper's verdict",
    title: meaningOf("at_first_closure") ?? "",
    cell: ({ outcome }) => (outcome === null ? "" : classStyle(outcome.at_first_closure).words),
  },
];

function Head({ column, query }: { readonly column: Column; readonly query: LibraryQuery }) {
  const sorted = query.sort === column.key ? (query.descending ? "descending" : "ascending") : undefined;
  return (
    <th scope="col" aria-sort={sorted} data-column={column.key} data-number={column.number}>
      <Tooltip label={column.title} w={280} position="bottom">
        <button
          type="button"
          onClick={() => {
            showQuery(sortedBy(query, column.key));
          }}
        >
          {column.label}
          <span aria-hidden="true">{sorted === undefined ? "" : sorted === "descending" ? " ↓" : " ↑"}</span>
        </button>
      </Tooltip>
    </th>
  );
}

/** All runs of the page, or none. */
function SelectPage({ runs, selection }: { readonly runs: readonly RunSummary[]; readonly selection: Selection }) {
  const extent = extentOf(selection.selected, runs);
  return (
    <th scope="col" className={styles.select}>
      <Checkbox
        size="xs"
        aria-label="Select all runs on this page"
        checked={extent === "all"}
        indeterminate={extent === "some"}
        onChange={() => {
          selection.set(runs, extent !== "all");
        }}
      />
    </th>
  );
}

interface RunTableProps {
  readonly runs: readonly RunSummary[];
  readonly query: LibraryQuery;
  readonly selection: Selection;
}

export function RunTable({ runs, query, selection }: RunTableProps) {
  return (
    <div className={styles.scroll} role="region" aria-label="Table of runs" tabIndex={0}>
      <table className={styles.table}>
        <thead>
          <tr>
            <SelectPage runs={runs} selection={selection} />
            {COLUMNS.map((column) => (
              <Head key={column.key} column={column} query={query} />
            ))}
          </tr>
        </thead>
        <tbody>
          {runs.map((run) => (
            <tr key={run.id} data-run={run.id} data-selected={selection.selected.has(run.id) || undefined}>
              <td className={styles.select}>
                <Checkbox
                  size="xs"
                  aria-label={`Select run ${run.id}`}
                  title="With Shift: all from the one before"
                  checked={selection.selected.has(run.id)}
                  onChange={(event) => {
                    selection.press(runs, run.id, event.nativeEvent instanceof MouseEvent && event.nativeEvent.shiftKey);
                  }}
                />
              </td>
              {COLUMNS.map((column) => (
                <td key={column.key} data-number={column.number} data-column={column.key}>
                  {column.cell(run, query)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

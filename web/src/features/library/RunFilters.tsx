/** What of the library is shown: kept in the address, so that a reload and a link show the same. */
import { Button, Switch, TextInput } from "@mantine/core";
import { useEffect, useState } from "react";
import { Icon } from "../../ui/theme/Icon";
import { classStyle } from "../glossary/class-style";
import { Choice } from "../../ui/Choice";
import { showQuery, isFiltered, KINDS, DEFAULT_QUERY, STATUSES, VERDICTS, type LibraryQuery } from "./query";
import styles from "./LibraryPage.module.css";
import { SavedFilters } from "./SavedFilters";
import { STATUS_CHOICES } from "./labels";

/** Milliseconds after the last key of a search. */
const TYPING_PAUSE = 250;

interface FilterProps {
  readonly query: LibraryQuery;
  readonly item: string;
  readonly other: string;
}

const choices = <Value extends string>(all: string, values: readonly Value[], words: (value: Value) => string) => [
  { value: "", label: all },
  ...values.map((value) => ({ value, label: words(value) })),
];

const spelled = (value: string): string => value.replaceAll("_", " ");
const verdict = (value: string): string => classStyle(value).words;

/** The search asks when nobody types any more; what the address says meanwhile is what was typed before. */
function Search({ query, item, other }: FilterProps) {
  const [typed, setTyped] = useState<string | null>(null);
  useEffect(() => {
    if (typed === null) return undefined;
    const timer = setTimeout(() => {
      showQuery({ ...query, text: typed, page: 1 }, item, other);
      setTyped(null);
    }, TYPING_PAUSE);
    return () => {
      clearTimeout(timer);
    };
  }, [typed, query, item, other]);
  return (
    <TextInput
      aria-label="Search runs"
      placeholder="Name, tag, note, configuration, changed parameter"
      leftSection={<Icon icon="search" />}
      value={typed ?? query.text}
      onChange={(event) => {
        setTyped(event.currentTarget.value);
      }}
    />
  );
}

export function RunFilters({ query, item, other }: FilterProps) {
  const change = (change: Partial<LibraryQuery>): void => {
    showQuery({ ...query, ...change, page: 1 }, item, other);
  };
  const choice = (name: "kind" | "status" | "outcome" | "at_first_closure", label: string, data: { value: string; label: string }[]) => (
    <Choice aria-label={label} value={query[name]} data={data} onChange={(value) => { change({ [name]: value }); }} />
  );
  return (
    <div className={styles.filters} role="search">
      <Search query={query} item={item} other={other} />
      {choice("kind", "Kind", choices("All kinds", KINDS, spelled))}
      {choice("status", "Status", choices("All statuses", STATUSES, (value) => STATUS_CHOICES[value]))}
      {choice("outcome", "Verdict", choices("All verdicts", VERDICTS, verdict))}
      {choice("at_first_closure", "Paper's verdict", choices("Paper's verdict: all", VERDICTS, (value) => `Paper's: ${verdict(value)}`))}
      <Switch size="xs" label="Starred only" checked={query.starred} onChange={(event) => { change({ starred: event.currentTarget.checked }); }} />
      {query.tag !== "" && (
        <Button size="compact-xs" aria-label={`Remove the filter by tag ${query.tag}`} onClick={() => { change({ tag: "" }); }}>
          {`Tag: ${query.tag} ×`}
        </Button>
      )}
      <SavedFilters query={query} item={item} other={other} />
      {isFiltered(query) && (
        <Button size="compact-xs" onClick={() => { change({ ...DEFAULT_QUERY, sort: query.sort, descending: query.descending }); }}>
          Clear filters
        </Button>
      )}
    </div>
  );
}

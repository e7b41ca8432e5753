/** What of the library is shown: kept in the address, so that a reload and a link show the same. */
import { Button, Switch, TextInput } from "@mantine/core";
import { useEffect, useState } from "react";
import { Icon } from "../../ui/theme/Icon";
import { lookOf } from "../glossary/class-style";
import { Choice } from "../../ui/Choice";
import { ask, isFiltered, KINDS, NO_WISH, STATUSES, VERDICTS, type LibraryQuery } from "./query";
import styles from "./LibraryPage.module.css";
import { STATUS_CHOICES } from "./words";

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
const verdict = (value: string): string => lookOf(value).words;

/** The search asks when nobody types any more; what the address says meanwhile is what was typed before. */
function Search({ query, item, other }: FilterProps) {
  const [typed, setTyped] = useState<string | null>(null);
  useEffect(() => {
    if (typed === null) return undefined;
    const timer = setTimeout(() => {
      ask({ ...query, text: typed, page: 1 }, item, other);
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
      leftSection={<Icon sign="search" />}
      value={typed ?? query.text}
      onChange={(event) => {
        setTyped(event.currentTarget.value);
      }}
    />
  );
}

export function RunFilters({ query, item, other }: FilterProps) {
  const wish = (change: Partial<LibraryQuery>): void => {
    ask({ ...query, ...change, page: 1 }, item, other);
  };
  const choice = (name: "kind" | "status" | "outcome" | "at_first_closure", label: string, data: { value: string; label: string }[]) => (
    <Choice aria-label={label} value={query[name]} data={data} onChange={(value) => { wish({ [name]: value }); }} />
  );
  return (
    <div className={styles.filters} role="search">
      <Search query={query} item={item} other={other} />
      {choice("kind", "Kind", choices("Every kind", KINDS, spelled))}
      {choice("status", "Status", choices("Every status", STATUSES, (value) => STATUS_CHOICES[value]))}
      {choice("outcome", "Verdict", choices("Every verdict", VERDICTS, verdict))}
      {choice("at_first_closure", "Paper's verdict", choices("Paper's verdict: every", VERDICTS, (value) => `Paper's: ${verdict(value)}`))}
      <Switch size="xs" label="Starred only" checked={query.starred} onChange={(event) => { wish({ starred: event.currentTarget.checked }); }} />
      {query.tag !== "" && (
        <Button size="compact-xs" aria-label={`Any tag, not only ${query.tag}`} onClick={() => { wish({ tag: "" }); }}>
          {`Tag: ${query.tag} ×`}
        </Button>
      )}
      {isFiltered(query) && (
        <Button size="compact-xs" onClick={() => { wish({ ...NO_WISH, sort: query.sort, descending: query.descending }); }}>
          Show all
        </Button>
      )}
    </div>
  );
}

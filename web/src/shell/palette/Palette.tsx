/** Everything of the console by its name: pages, commands, parameters, words and help. Opens by Ctrl+K. */
import { TextInput } from "@mantine/core";
import { useEffect, useId, useRef, useState, type KeyboardEvent } from "react";
import { Overlay } from "../../ui/Overlay";
import { Icon } from "../../ui/theme/Icon";
import { found, stepped, type Entry } from "./entries";
import styles from "./Palette.module.css";
import { UNASKED, useEntries } from "./use-entries";

interface PaletteProps {
  readonly onClose: () => void;
  readonly onHelp: () => void;
}

function Options({ entries, place, id, onRun }: { readonly entries: readonly Entry[]; readonly place: number; readonly id: string; readonly onRun: (entry: Entry) => void }) {
  const list = useRef<HTMLUListElement>(null);
  useEffect(() => {
    list.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
  }, [place, entries]);
  return (
    <ul ref={list} className={styles.list} role="listbox" id={id} aria-label="Found">
      {entries.map((entry, at) => (
        <li key={entry.id} id={`${id}-${at}`} role="option" aria-selected={at === place} onClick={() => { onRun(entry); }}>
          <span className={styles.group}>{entry.group}</span>
          <span className={styles.label}>{entry.label}</span>
          <span className={styles.hint}>{entry.hint}</span>
        </li>
      ))}
    </ul>
  );
}

export function Palette({ onClose, onHelp }: PaletteProps) {
  const id = useId();
  const [text, setText] = useState("");
  const [place, setPlace] = useState(0);
  const entries = found(useEntries(onHelp), text, UNASKED);
  const run = (entry: Entry | undefined): void => {
    if (entry === undefined || entry.group === "Words") return;
    onClose();
    entry.run();
  };
  const onKeyDown = (event: KeyboardEvent): void => {
    if (event.key === "Enter") run(entries[place]);
    else if (event.key === "ArrowDown" || event.key === "ArrowUp") setPlace(stepped(place, event.key, entries.length));
    else return;
    event.preventDefault();
  };
  return (
    <Overlay label="Command palette" onClose={onClose}>
      <TextInput
        data-autofocus
        size="md"
        role="combobox"
        aria-label="Search everything"
        aria-expanded
        aria-controls={id}
        aria-activedescendant={entries.length === 0 ? undefined : `${id}-${place}`}
        placeholder="A page, command, parameter, word or topic"
        leftSection={<Icon icon="search" />}
        value={text}
        onChange={(event) => { setText(event.currentTarget.value); setPlace(0); }}
        onKeyDown={onKeyDown}
      />
      <Options entries={entries} place={place} id={id} onRun={run} />
      {entries.length === 0 && <p className={styles.none} role="status">Nothing of that name.</p>}
    </Overlay>
  );
}

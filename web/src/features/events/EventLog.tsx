/** What happened, the latest at the bottom and in view unless the reader has scrolled back. */
import { ActionIcon, TextInput } from "@mantine/core";
import { useMemo, useRef, useState } from "react";
import { Choice } from "../../ui/Choice";
import { saveFile } from "../../ui/export/save-file";
import { Panel } from "../../ui/Panel";
import type { MissionEvent } from "../../api/types";
import { useStore, useView } from "../../store/context";
import { useAccess } from "../access/session";
import { Icon, SEVERITY_ICON } from "../../ui/theme/Icon";
import { clock } from "../../units/units";
import styles from "./EventLog.module.css";
import { CHOICE_WORDS, CHOICES, eventsAsCsv, eventsThatFit, type EventChoice } from "./filter";

/** Within this many pixels of its end the log is at its end. */
const END = 24;

/** When it happened; of a stored run a press shows that moment. */
function When({ event }: { readonly event: MissionEvent }) {
  const { playback } = useStore().source;
  const time = (
    <time className={styles.time} dateTime={event.at} title={`tick ${event.tick}, ${event.at}`}>
      {clock(event.time, 2)}
    </time>
  );
  if (playback === null) return time;
  return (
    <button type="button" className={styles.moment} title={`Show this moment: tick ${event.tick}, ${event.at}`} onClick={() => { playback.seek(event.time); }}>
      {clock(event.time, 2)}
    </button>
  );
}

function Entry({ event }: { readonly event: MissionEvent }) {
  const { session } = useAccess();
  // Where nobody signs in, all is by the one operator.
  const who = session?.token_needed === true && event.who ? event.who : null;
  return (
    <li className={styles.event} data-severity={event.severity} data-kind={event.kind}>
      <When event={event} />
      {event.severity !== "info" && (
        <>
          <Icon icon={SEVERITY_ICON[event.severity]} size={13} />
          <span className="visually-hidden">{event.severity}:</span>
        </>
      )}
      <span className={styles.message}>
        {event.message}
        {who !== null && <span className={styles.who}> by {who}</span>}
      </span>
    </li>
  );
}

interface ToolsProps {
  readonly events: readonly MissionEvent[];
  readonly choice: EventChoice;
  readonly onChoice: (choice: EventChoice) => void;
  readonly sought: string;
  readonly onSought: (sought: string) => void;
}

function Tools({ events, choice, onChoice, sought, onSought }: ToolsProps) {
  const run = useView((view) => view.run?.id ?? "mission");
  return (
    <div className={styles.tools} role="search" aria-label="Search events">
      <TextInput aria-label="Search events" placeholder="Search" leftSection={<Icon icon="search" size={12} />} value={sought} onChange={(event) => { onSought(event.currentTarget.value); }} />
      <Choice aria-label="Kind of events" value={choice} data={CHOICES.map((value) => ({ value, label: CHOICE_WORDS[value] }))} onChange={(value) => { onChoice(CHOICES.find((known) => known === value) ?? "all"); }} />
      <ActionIcon aria-label="Export these events as CSV" title="Export these events as CSV" disabled={events.length === 0} onClick={() => { saveFile(new Blob([eventsAsCsv(events)], { type: "text/csv" }), `becalm-${run}-events.csv`); }}>
        <Icon icon="download" size={12} />
      </ActionIcon>
    </div>
  );
}

export function EventLog() {
  const all = useView((view) => view.events);
  const [choice, setChoice] = useState<EventChoice>("all");
  const [sought, setSought] = useState("");
  const events = useMemo(() => eventsThatFit(all, choice, sought), [all, choice, sought]);
  const log = useRef<HTMLDivElement>(null);
  const [back, setBack] = useState(false);

  const latest = back && (
    <button type="button" className={styles.latest} onClick={() => log.current?.scrollTo({ top: 0 })}>
      Latest
    </button>
  );
  return (
    <Panel title={events.length === all.length ? "Events" : `${events.length} of ${all.length} events`} grow dated="service" aside={latest}>
      <Tools events={events} choice={choice} onChoice={setChoice} sought={sought} onSought={setSought} />
      <div
        ref={log}
        className={styles.log}
        role="log"
        aria-label="Events"
        tabIndex={0}
        onScroll={(event) => {
          // The list is laid out from its end, so that the end is at 0 and stays in view.
          setBack(event.currentTarget.scrollTop < -END);
        }}
      >
        <ol className={styles.list}>
          {events.map((event) => (
            <Entry key={`${event.tick} ${event.kind} ${event.message} ${event.at}`} event={event} />
          ))}
          {events.length === 0 && <li className={styles.none}>{all.length === 0 ? "No events yet." : "No matching events."}</li>}
        </ol>
      </div>
    </Panel>
  );
}

/** What happened, the latest at the bottom and in view unless the reader has scrolled back. */
import { useRef, useState } from "react";
import { Panel } from "../../ui/Panel";
import type { MissionEvent } from "../../api/types";
import { useView } from "../../store/context";
import { useAccess } from "../access/session";
import { Icon, SEVERITY_ICON } from "../../ui/theme/Icon";
import { clock } from "../../units/units";
import styles from "./EventLog.module.css";

/** Within this many pixels of its end the log is at its end. */
const END = 24;

function Entry({ event }: { readonly event: MissionEvent }) {
  const { session } = useAccess();
  // Where nobody signs in, all is by the one operator.
  const who = session?.token_needed === true && event.who ? event.who : null;
  return (
    <li className={styles.event} data-severity={event.severity} data-kind={event.kind}>
      <time className={styles.time} dateTime={event.at} title={`tick ${event.tick}, ${event.at}`}>
        {clock(event.time, 2)}
      </time>
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

export function EventLog() {
  const events = useView((view) => view.events);
  const log = useRef<HTMLDivElement>(null);
  const [back, setBack] = useState(false);

  const latest = back && (
    <button type="button" className={styles.latest} onClick={() => log.current?.scrollTo({ top: 0 })}>
      Latest
    </button>
  );
  return (
    <Panel title="Events" grow dated="service" aside={latest}>
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
          {events.length === 0 && <li className={styles.none}>No events yet.</li>}
        </ol>
      </div>
    </Panel>
  );
}

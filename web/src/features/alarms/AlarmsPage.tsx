/** Alarms of the live mission, their limits, what happened to them, and the shift log. */
import { Switch } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { readControl } from "../../api/service";
import { Panel } from "../../ui/Panel";
import { useShared } from "../../ui/use-shared";
import { AlarmList } from "./AlarmList";
import styles from "./AlarmsPage.module.css";
import { NOTIFICATIONS, sound, SOUND } from "./announce";
import { LimitTable } from "./LimitTable";
import { AlarmHistory, ShiftLog } from "./Records";

/** Chosen for this browser. */
function Announcing() {
  const [withSound, setSound] = useShared(SOUND);
  const [withNotices, setNotices] = useShared(NOTIFICATIONS);
  const possible = "Notification" in window && window.isSecureContext;
  const refused = possible && Notification.permission === "denied";
  const askFirst = async (): Promise<void> => {
    setNotices((await Notification.requestPermission()) === "granted" ? "on" : "off");
  };
  const why = !possible ? "This browser shows notifications only over TLS or on this computer." : refused ? "This browser was told to show none; its settings for this page change that." : "Shown while another tab or window is in front";
  return (
    <Panel title="In this browser">
      <div className={styles.writing}>
        <Switch size="xs" label="Sound: two tones for a warning; critical ones again every 10 s until acknowledged" checked={withSound === "on"} onChange={(event) => { const on = event.currentTarget.checked; setSound(on ? "on" : "off"); if (on) sound("warning"); }} />
        <Switch size="xs" label="Notifications" description={why} disabled={!possible || refused} checked={withNotices === "on" && possible && !refused} onChange={(event) => { if (event.currentTarget.checked) void askFirst(); else setNotices("off"); }} />
        <p className={styles.dim}>The title and the icon of the tab always show what is to be acknowledged.</p>
      </div>
    </Panel>
  );
}

const PERIOD = 5000;

function Watching({ shown }: { readonly shown: boolean }) {
  const { data } = useQuery({ queryKey: ["watching"], queryFn: readControl, enabled: shown, refetchInterval: PERIOD });
  const watching = Object.entries(data?.watching ?? {});
  return (
    <Panel title="Who is watching">
      <ul className={styles.watching} aria-label="Who is watching">
        {watching.map(([name, pages]) => (
          <li key={name}>
            <b>{name}</b> {pages === 1 ? "on one page" : `on ${pages} pages`}
            {data?.control.holder === name && ", in control"}
          </li>
        ))}
        {watching.length === 0 && <li className={styles.none}>Not known.</li>}
      </ul>
    </Panel>
  );
}

export function AlarmsPage({ shown }: { readonly shown: boolean }) {
  return (
    <main className={styles.page} hidden={!shown}>
      <div className={styles.column}>
        <AlarmList />
        <Announcing />
      </div>
      <div className={styles.column}>
        <LimitTable shown={shown} />
        <AlarmHistory shown={shown} />
      </div>
      <div className={styles.column}>
        <Watching shown={shown} />
        <ShiftLog shown={shown} />
      </div>
    </main>
  );
}

/** How many alarms there are, on every page; a press leads to their list. */
import { useView } from "../../store/context";
import { hashOf } from "../../store/route";
import { Icon } from "../../ui/theme/Icon";
import styles from "./AlarmState.module.css";
import { highest, LEVEL_ICONS, speaks } from "./alarms";

export function AlarmState() {
  const alarms = useView((view) => view.alarms);
  const speaking = alarms.filter(speaks);
  const level = highest(speaking.length > 0 ? speaking : alarms);
  const words = alarms.length === 0 ? "No alarms" : speaking.length > 0 ? `${speaking.length} to acknowledge` : `${alarms.length} seen`;
  const list = alarms.map(({ title, level: each }) => `${each}: ${title}`).join("\n");
  return (
    <>
      <a className={styles.state} data-level={level ?? undefined} data-speaks={speaking.length > 0 || undefined} href={hashOf({ page: "alarms", item: "" })} aria-label={`Alarms: ${words}`} title={list || "Nothing is beyond its limits"}>
        <Icon icon={level === null ? "check" : LEVEL_ICONS[level]} size={13} />
        {words}
      </a>
      <span className="visually-hidden" role="status" aria-live={speaking.length > 0 ? "assertive" : "polite"}>
        {`Alarms: ${words}`}
      </span>
    </>
  );
}

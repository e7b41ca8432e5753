/** What alarms say: pure functions from the list to what is heard, shown and read. */
import type { Alarm } from "../../api/types";
import type { IconName } from "../../ui/theme/Icon";
import { plain, shown, type AngleUnit } from "../../units/units";

export type AlarmLevel = Alarm["level"];

/** The least first. */
export const LEVELS: readonly AlarmLevel[] = ["watch", "warning", "critical"];

/** A level by its shape, too. */
export const LEVEL_ICONS: Readonly<Record<AlarmLevel, IconName>> = { watch: "info", warning: "warning", critical: "error" };

/** Whether it wants to be heard: nobody has acknowledged or shelved it, and it is more than worth a look. */
export const speaks = ({ level, acknowledged_at: seen, shelved_until: shelved }: Alarm): boolean => level !== "watch" && seen === null && shelved === null;

export function highest(alarms: readonly Alarm[]): AlarmLevel | null {
  const place = Math.max(...alarms.map(({ level }) => LEVELS.indexOf(level)), -1);
  return LEVELS[place] ?? null;
}

/** The most urgent first: what speaks, by its level, then the newest. */
export function inOrder(alarms: readonly Alarm[]): Alarm[] {
  const rank = (alarm: Alarm): number => (speaks(alarm) ? 10 : alarm.shelved_until === null ? 5 : 0) + LEVELS.indexOf(alarm.level);
  return [...alarms].sort((one, other) => rank(other) - rank(one) || other.raised_at.localeCompare(one.raised_at));
}

/** In four figures, in the unit that a person prefers. */
export function valueWords(value: number | null, unit: string, angles: AngleUnit): string {
  if (value === null) return "";
  const { factor, unit: typeset } = shown(unit, angles);
  return `${plain(Number((value * factor).toPrecision(4)))} ${typeset}`.trim();
}

/** Such as "1.87 N, above 1.2 N". */
export function beyondWords(alarm: Alarm, angles: AngleUnit): string {
  if (alarm.signal === null || alarm.bound === null) return alarm.message;
  const bound = `${alarm.side ?? ""} ${valueWords(alarm.bound, alarm.unit, angles)}`;
  const worst = valueWords(alarm.worst, alarm.unit, angles);
  return alarm.active ? `${valueWords(alarm.value, alarm.unit, angles)}, ${bound}; worst ${worst}` : `was ${worst}, ${bound}; over`;
}

/** What the title of the page says, so that it is read on a tab that nobody looks at. */
export function titleOf(alarms: readonly Alarm[], phase: string | null): string {
  const speaking = alarms.filter(speaks);
  const mark = speaking.length === 0 ? "" : highest(speaking) === "critical" ? `(${speaking.length} ‼) ` : `(${speaking.length} !) `;
  return `${mark}${phase === null ? "" : `${phase} · `}Becalm`;
}

/** What a notification says. */
export const noticeWords = (alarm: Alarm, angles: AngleUnit): string => `${alarm.level === "critical" ? "Critical" : "Warning"}: ${alarm.title}`.concat(alarm.signal === null ? "" : `, ${valueWords(alarm.worst, alarm.unit, angles)}`);

/** Alarms that speak now and did not before: raised anew, or worse. */
export function newlySpeaking(before: readonly Alarm[], now: readonly Alarm[]): Alarm[] {
  const heard = new Set(before.filter(speaks).map(nameOf));
  return now.filter((alarm) => speaks(alarm) && !heard.has(nameOf(alarm)));
}

const nameOf = ({ key, level, raised_at: at }: Alarm): string => `${key} ${level} ${at}`;

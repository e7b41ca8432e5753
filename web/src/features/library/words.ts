/** Runs in words: what was changed, and when they began. */
import type { RunSummary } from "../../api/types";
import { plain, shown } from "../../units/units";

export type Change = RunSummary["changes"][number];

const valueOf = (value: unknown): string => (typeof value === "number" ? plain(value) : String(value).replaceAll("_", " "));

/** The last part of a path, which names the parameter where its group is known. */
const shortName = (path: string): string => (path.split(".").at(-1) ?? path).replaceAll("_", " ");

/** "damping 1.5 → 3 N·s/m". */
export function changeWords({ path, unit, configured, value }: Change): string {
  const typeset = shown(unit, "rad").unit;
  return `${shortName(path)} ${valueOf(configured)} → ${valueOf(value)}${typeset === "" ? "" : ` ${typeset}`}`;
}

/** All of them, the full paths too, for who looks closely. */
export const changesTitle = (changes: readonly Change[]): string =>
  changes.map((change) => `${change.path}: ${change.title}\n    ${changeWords(change)}`).join("\n");

/** The named configuration without the mark of an edited one: what was edited stands beside it. */
export const configurationWords = ({ configuration, direct }: Pick<RunSummary, "configuration" | "direct">): string =>
  configuration.replace(/ \(edited\)$/, "") + (direct ? ", direct" : "");

/** Today the time, else the day and the time: as short as tells neighbours apart. */
export function momentWords(started: string, now: Date): string {
  const at = new Date(started);
  const time = at.toLocaleTimeString(undefined, { timeStyle: "medium" });
  return at.toDateString() === now.toDateString() ? time : `${at.toLocaleDateString(undefined, { dateStyle: "short" })} ${time}`;
}

/** Runs in words: what was changed, and when they began. */
import type { RunSummary } from "../../api/types";
import { isPoints, pointsText } from "../../units/points";
import { plain, shown } from "../../units/units";

export type Change = RunSummary["changes"][number];

const valueOf = (value: unknown): string => (isPoints(value) ? pointsText(value) : typeof value === "number" ? plain(value) : String(value).replaceAll("_", " "));

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

/** What a run is doing, or how it ended without a verdict: cut off, ended by a reset, ended by STOP; else by its status. */
export function statusWords({ status, kind, integrity, note }: Pick<RunSummary, "status" | "kind" | "integrity" | "note">): string {
  if (status === "failed" && integrity === "recovered") return "cut off";
  const flown = kind === "live" || kind === "fork";
  if (status !== "cancelled" || !flown) return status;
  // The service's note of a live run without a verdict is how it ended; runs of 0.1.0 have none.
  return note?.split(":")[0] ?? "ended early";
}

/** Tags as a person types them, with commas between. */
export const tagsOf = (typed: string): string[] => typed.split(",").map((tag) => tag.trim()).filter((tag) => tag !== "");

/** Of events that are left out, one or more; null: of all. */
export function damageWords(events: number | null): string {
  if (events === null) return "The events of this run cannot be read.";
  return events === 1 ? "One event of this run is damaged and left out." : `${events} events of this run are damaged and left out.`;
}

/** What a filter calls each status; a live run that ended early and a scripted one that was cancelled have the same. */
export const STATUS_CHOICES: Readonly<Record<RunSummary["status"], string>> = {
  queued: "queued",
  running: "running",
  finished: "finished",
  failed: "failed or cut off",
  cancelled: "ended early",
};

/** The named configuration without the mark of an edited one: what was edited stands beside it. */
export const configurationWords = ({ configuration, direct }: Pick<RunSummary, "configuration" | "direct">): string =>
  configuration.replace(/ \(edited\)$/, "") + (direct ? ", direct" : "");

/** Today the time, else the day and the time: as short as tells neighbours apart. */
export function momentWords(started: string, now: Date): string {
  const at = new Date(started);
  const time = at.toLocaleTimeString(undefined, { timeStyle: "medium" });
  return at.toDateString() === now.toDateString() ? time : `${at.toLocaleDateString(undefined, { dateStyle: "short" })} ${time}`;
}

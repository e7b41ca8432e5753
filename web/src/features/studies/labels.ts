/** What is said of a study in a few words. */
import type { StudyEstimate } from "../../api/types";
import { duration, plain, shown } from "../../units/units";

/** How long a study takes: no part of a second is known. */
export const span = (seconds: number): string => duration(Math.ceil(seconds), 0);

/** A duration that is an estimate: two figures are enough. */
export function about(seconds: number): string {
  if (seconds < 10) return `about ${Math.max(1, Math.round(seconds))} s`;
  const unit = 10 ** Math.floor(Math.log10(seconds) - 1);
  return `about ${span(Math.round(seconds / unit) * unit)}`;
}

export const counted = (count: number, one: string, many = `${one}s`): string => `${count.toLocaleString("en").replaceAll(",", "\u202f")} ${count === 1 ? one : many}`;

/** How large a study would be and how long it would take, in one or two sentences. */
export function estimateWords({ cells, seconds, measuring, basis, studies_before: before }: StudyEstimate): string {
  const time = measuring ? "; measuring how long they take" : seconds === null ? `; how long they take is not known: ${basis}` : `, ${about(seconds)}`;
  const after = before > 0 ? ` It starts after ${counted(before, "study that runs or waits", "studies that run or wait")}.` : "";
  return `${counted(cells, "cell")}${time}.${after}`;
}

/** The values of an axis as they were understood, such as "5 values: 0, 1.5, … 6 N·s/m". */
export function valuesWords({ count, values, unit }: StudyEstimate["axes"][number]): string {
  if (count === null || values === null) return "";
  const words = values.map((value) => (typeof value === "number" ? plain(value) : value));
  const listed = count <= 4 ? words.join(", ") : `${words.slice(0, 2).join(", ")}, … ${words.at(-1) ?? ""}`;
  return `${counted(count, "value")}: ${listed} ${shown(unit, "rad").unit}`.trim();
}

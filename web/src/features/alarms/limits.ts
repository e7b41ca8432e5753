/** Limits as they are typed. */
import type { Limits } from "../../api/types";
import { readNumber } from "../../units/numbers";

export const FIELDS = ["watch", "warning", "critical", "hysteresis"] as const;

/** What stands in the fields that were edited, in the unit that is shown. */
export type Typed = Readonly<Partial<Record<(typeof FIELDS)[number], string>>>;

/** What would be kept, in SI; an empty level is none. @param factor of the unit that is shown. */
export function limitsOf(before: Limits, typed: Typed, factor: number): Limits | { readonly fault: string } {
  const next: Record<string, number | null> = { watch: before.watch ?? null, warning: before.warning ?? null, critical: before.critical ?? null, hysteresis: before.hysteresis };
  for (const [field, text] of Object.entries(typed)) {
    if (text.trim() === "" && field !== "hysteresis") {
      next[field] = null;
      continue;
    }
    const read = readNumber(text);
    if ("error" in read) return { fault: `${field}: ${read.error}` };
    if (field === "hysteresis" && read.value < 0) return { fault: "hysteresis: must be at least 0" };
    next[field] = read.value / factor;
  }
  return next as unknown as Limits;
}

/** What is asked of a rehearsal, from what a person typed. */
import { createContext, useContext, useMemo, useState } from "react";
import type { MissionSnapshot, RehearsalRequest, UncertaintyField } from "../../api/types";
import { readNumber, readWhole, type NumberRead } from "../../units/numbers";
import { plain } from "../../units/units";

/** `next`: what comes next as the mission is. `continue`: what is under way. */
export const REQUESTS = ["next", "capture", "cage", "direct_cage", "continue"] as const;
export type Requested = (typeof REQUESTS)[number];

export interface Plan {
  readonly requested: Requested;
  readonly futures: string;
  readonly seed: string;
  /** Fields of the uncertainty model whose text was edited. */
  readonly uncertainty: Readonly<Record<string, string>>;
}

export const PLAN: Plan = { requested: "next", futures: "100", seed: "0", uncertainty: {} };

export interface PlanState {
  readonly plan: Plan;
  readonly change: (part: Partial<Plan>) => void;
}

export const PlanContext = createContext<PlanState>({ plan: PLAN, change: () => undefined });

export const usePlan = (): PlanState => useContext(PlanContext);

export function usePlanState(): PlanState {
  const [plan, setPlan] = useState(PLAN);
  return useMemo(() => ({ plan, change: (part) => { setPlan((old) => ({ ...old, ...part })); } }), [plan]);
}

const UNDER_WAY: readonly string[] = ["detumbling", "caging"];

/** What a rehearsal begins with: what comes next is a capture, or what is under way where something is. */
export function requestOf(requested: Requested, phase: string | null): RehearsalRequest["request"] {
  if (requested === "continue") return null;
  if (requested !== "next") return requested;
  return phase !== null && UNDER_WAY.includes(phase) ? null : "capture";
}

export const MOST_FUTURES = 2000;

/** The number of futures, or what is wrong with it. */
export function futuresOf(typed: string): NumberRead {
  const read = readWhole(typed);
  if ("error" in read) return read;
  return read.value >= 1 && read.value <= MOST_FUTURES ? read : { error: `must be from 1 to ${MOST_FUTURES}` };
}

function seedOf(typed: string): NumberRead {
  const read = readWhole(typed);
  return "error" in read || read.value >= 0 ? read : { error: "must be at least 0" };
}

/** A field of the uncertainty model, or what is wrong with what stands in it. */
export function uncertaintyOf(field: UncertaintyField, typed: string): NumberRead {
  const read = readNumber(typed);
  if ("error" in read || (read.value >= field.minimum && read.value <= field.maximum)) return read;
  return { error: `must be from ${plain(field.minimum)} to ${plain(field.maximum)}${field.unit === "1" ? "" : ` ${field.unit}`}` };
}

/** What is wrong with a plan, by field; nothing if it can be asked for. */
export function faultsOf({ futures, seed, uncertainty }: Plan, fields: readonly UncertaintyField[]): ReadonlyMap<string, string> {
  const reads: [string, NumberRead][] = [["futures", futuresOf(futures)], ["seed", seedOf(seed)]];
  for (const field of fields) {
    const typed = uncertainty[field.name];
    if (typed !== undefined) reads.push([field.name, uncertaintyOf(field, typed)]);
  }
  return new Map(reads.flatMap(([name, read]): [string, string][] => ("error" in read ? [[name, read.error]] : [])));
}

/** The number that stands there; of what is at fault nothing is asked. */
const numberIn = (read: NumberRead): number => ("value" in read ? read.value : Number.NaN);

/** Only what differs from the defaults of the service. */
export const editedUncertainty = ({ uncertainty }: Plan, fields: readonly UncertaintyField[]): Record<string, number> =>
  Object.fromEntries(
    fields.flatMap((field): [string, number][] => {
      const typed = uncertainty[field.name];
      const value = typed === undefined ? field.default : numberIn(uncertaintyOf(field, typed));
      return value === field.default ? [] : [[field.name, value]];
    }),
  );

/** Mission time after which a future is unresolved, seconds. */
export const HORIZON = 20;

/** Names this page, whose newer requests take the place of older ones. */
const PAGE = Math.random().toString(36).slice(2, 10);

export const askerOf = (what: "rehearsal" | "moment" | "atlas" | "fit"): string => `console-${PAGE}-${what}`;

/** The state that futures begin in: at that mission time of a run, or without one as the live mission is. */
interface Beginning {
  readonly run: string | null;
  readonly at: number | null;
  readonly phase: MissionSnapshot["phase"] | null;
}

export function rehearsalOf(plan: Plan, fields: readonly UncertaintyField[], { run, at, phase }: Beginning, changes: Record<string, unknown>): RehearsalRequest {
  const stored = run !== null && at !== null;
  return {
    source: stored ? { run, at } : "live",
    changes,
    request: requestOf(plan.requested, phase),
    futures: numberIn(futuresOf(plan.futures)),
    seed: numberIn(seedOf(plan.seed)),
    horizon: HORIZON,
    uncertainty: editedUncertainty(plan, fields),
    asker: askerOf(stored ? "moment" : "rehearsal"),
  };
}

/** What is asked of an atlas, from what a person typed: two parameters, their ranges, a few futures a cell. */
import type { AtlasRequest, MissionSnapshot, Parameter, UncertaintyField } from "../../api/types";
import { readNumber, readWhole } from "../../units/numbers";
import { plain } from "../../units/units";
import { valueAt } from "../parameters/draft";
import { askerOf, editedUncertainty, HORIZON, requestOf, type Plan, type Requested } from "../rehearsal/plan";

export interface AxisDraft {
  readonly path: string;
  readonly from: string;
  readonly to: string;
  readonly count: string;
}

export interface AtlasDraft {
  readonly x: AxisDraft;
  readonly y: AxisDraft;
  readonly requested: Requested;
  readonly futures: string;
  /** Whether the map is around what is staged, too. */
  readonly staged: boolean;
}

/** A moment of a stored run that the map begins in, in place of the present one. */
export interface RecordedState {
  readonly run: string;
  /** Mission time, seconds. */
  readonly at: number;
  /** Of that moment. */
  readonly phase: string;
}

/** The state that an address names, such as `#/atlas?run=20261125T103000123-4f9a2c&at=2.5&phase=idle`; null for the present one. */
export function stateIn(hash: string): RecordedState | null {
  const asked = new URLSearchParams(hash.split("?")[1] ?? "");
  const [run, at] = [asked.get("run") ?? "", Number(asked.get("at") ?? "")];
  return run === "" || !Number.isFinite(at) || at < 0 ? null : { run, at, phase: asked.get("phase") ?? "" };
}

export const MOST_VALUES = 21;
export const MOST_A_CELL = 10;

export type Axes = "x" | "y";

/** Numbers alone can be an axis. */
export const mayBeAxis = ({ type, choices }: Parameter): boolean => (type === "number" || type === "integer") && !choices;

const COUNT = 11;
/** Of a range about a value, either way. */
const REACH = 0.5;

/** A range about the present value, within the parameter's bounds. */
export function rangeAbout(parameter: Parameter, present: number): Pick<AxisDraft, "from" | "to"> {
  const { minimum, maximum, exclusive_minimum: above } = parameter;
  const reach = present === 0 ? 1 : REACH * Math.abs(present);
  const [low, high] = [present - reach, present + reach];
  const bottom = Math.max(low, minimum ?? above ?? -Infinity);
  const [from, to] = [bottom === above ? 0.1 * present : bottom, Math.min(high, maximum ?? Infinity)];
  const whole = (value: number): number => (parameter.type === "integer" ? Math.round(value) : Number(value.toPrecision(4)));
  return { from: plain(whole(from)), to: plain(whole(to)) };
}

/** An axis over that parameter, about its present value; as it was typed while there is no such parameter. */
export function axisFor(path: string, parameters: readonly Parameter[], config: unknown): AxisDraft {
  const parameter = parameters.find((each) => each.path === path);
  const present = valueAt(config, path);
  if (parameter === undefined || typeof present !== "number") return { path, from: "", to: "", count: String(COUNT) };
  return { path, ...rangeAbout(parameter, present), count: String(COUNT) };
}

/** The first two numbers of the configured method that may change in flight. */
export function usualPaths(parameters: readonly Parameter[], method: string): readonly [string, string] {
  const own = parameters.filter((each) => each.live && mayBeAxis(each) && each.group.startsWith(method)).map(({ path }) => path);
  const paper = ["published.impedance.damping", "published.impedance.stiffness"].filter((path) => own.includes(path));
  const [x = "", y = ""] = paper.length === 2 ? paper : own;
  return [x, y];
}

export interface AtlasRead {
  readonly request: AtlasRequest | null;
  /** What is wrong, by field: "x path", "y from", "futures" and so on. */
  readonly faults: ReadonlyMap<string, string>;
}

type Faults = Map<string, string>;

function readAxis(name: Axes, draft: AxisDraft, parameters: readonly Parameter[], faults: Faults): AtlasRequest["x"] {
  const path = draft.path.trim();
  const parameter = parameters.find((each) => each.path === path);
  if (path === "") faults.set(`${name} path`, "choose a parameter");
  else if (parameter === undefined) faults.set(`${name} path`, "there is no such parameter");
  else if (!mayBeAxis(parameter)) faults.set(`${name} path`, "only a number can be an axis");
  const [from, to, count] = [readNumber(draft.from), readNumber(draft.to), readWhole(draft.count)];
  if ("error" in from) faults.set(`${name} from`, from.error);
  if ("error" in to) faults.set(`${name} to`, to.error);
  if ("error" in count) faults.set(`${name} count`, count.error);
  else if (count.value < 2 || count.value > MOST_VALUES) faults.set(`${name} count`, `must be from 2 to ${MOST_VALUES}`);
  const number = (read: typeof from): number => ("value" in read ? read.value : Number.NaN);
  return { path, from: number(from), to: number(to), count: number(count) };
}

interface Around {
  readonly parameters: readonly Parameter[];
  readonly plan: Plan;
  readonly fields: readonly UncertaintyField[];
  /** Of the live mission. */
  readonly phase: MissionSnapshot["phase"] | null;
  /** What the map begins in; null for the live mission as it is now. */
  readonly state: RecordedState | null;
  /** What is staged, nested. */
  readonly changes: Record<string, unknown>;
}

/** The request, or what is wrong with it. Uncertainty and seed are those of the rehearsals. */
export function readAtlasDraft(draft: AtlasDraft, { parameters, plan, fields, phase, state, changes }: Around): AtlasRead {
  const faults: Faults = new Map();
  const [x, y] = [readAxis("x", draft.x, parameters, faults), readAxis("y", draft.y, parameters, faults)];
  if (x.path !== "" && x.path === y.path) faults.set("y path", "it is the other axis, too");
  const futures = readWhole(draft.futures);
  if ("error" in futures) faults.set("futures", futures.error);
  else if (futures.value < 1 || futures.value > MOST_A_CELL) faults.set("futures", `must be from 1 to ${MOST_A_CELL}`);
  const seed = readWhole(plan.seed);
  if ("error" in seed) faults.set("seed", seed.error);
  if (faults.size > 0 || "error" in futures || "error" in seed) return { request: null, faults };
  const request: AtlasRequest = {
    source: state === null ? "live" : { run: state.run, at: state.at },
    changes: draft.staged ? changes : {},
    request: requestOf(draft.requested, state === null ? phase : state.phase),
    x,
    y,
    futures: futures.value,
    seed: seed.value,
    horizon: HORIZON,
    uncertainty: editedUncertainty(plan, fields),
    asker: askerOf("atlas"),
  };
  return { request, faults };
}

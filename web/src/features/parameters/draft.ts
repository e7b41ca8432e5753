/** Edits that are staged but not yet applied: pure functions from what was typed to what would be sent. */
import { methodWords } from "../../source/methods";
import type { Parameter } from "../../api/types";
import { readNumber, readWhole } from "../../units/numbers";
import { isPoints, pointsText, readPoints, type Points } from "../../units/points";
import { plain, shown, type AngleUnit } from "../../units/units";

export type Value = number | string | Points;

/** A value of the service as the form takes it; undefined for a group, and for what is none. */
export const valueOf = (given: unknown): Value | undefined => (typeof given === "number" || typeof given === "string" || isPoints(given) ? given : undefined);

/** Full path to what stands in the field, in the unit it was typed in. */
export type Draft = Readonly<Record<string, { readonly text: string; readonly angles: AngleUnit }>>;

export interface Change {
  readonly parameter: Parameter;
  readonly from: Value;
  readonly to: Value;
}

/** The value at a full path of the nested configuration. */
export function valueAt(config: unknown, path: string): Value | undefined {
  let branch: unknown = config;
  for (const name of path.split(".")) {
    if (typeof branch !== "object" || branch === null) return undefined;
    branch = (branch as Record<string, unknown>)[name];
  }
  return valueOf(branch);
}

/** How a value stands in its field. */
export function fieldText(parameter: Parameter, value: Value, angles: AngleUnit): string {
  const { factor } = shown(parameter.unit, angles);
  if (typeof value === "string") return value;
  return typeof value === "number" ? plain(value * factor) : pointsText(value, factor);
}

/** What the field means in SI, or what is wrong with it. */
export function meaning(parameter: Parameter, text: string, angles: AngleUnit): { value: Value } | { error: string } {
  if (parameter.choices) return { value: text };
  if (parameter.type === "points") return pointsMeant(parameter, text, angles);
  const typed = parameter.type === "integer" ? readWhole(text) : readNumber(text);
  if ("error" in typed) return typed;
  const value = typed.value / shown(parameter.unit, angles).factor;
  const broken = brokenBound(parameter, value, angles);
  return broken === null ? { value } : { error: broken };
}

function pointsMeant(parameter: Parameter, text: string, angles: AngleUnit): { value: Value } | { error: string } {
  const typed = readPoints(text);
  if ("error" in typed) return typed;
  const { factor } = shown(parameter.unit, angles);
  const points = typed.points.map((point) => point.map((each) => each / factor));
  const { fewest, most } = parameter;
  if (typeof fewest === "number" && points.length < fewest) return { error: `must be at least ${fewest} points` };
  if (typeof most === "number" && points.length > most) return { error: `must be at most ${most} points` };
  const broken = points.flat().map((each) => brokenBound(parameter, each, angles)).find((each) => each !== null);
  return broken === undefined ? { value: points } : { error: `coordinates ${broken}` };
}

function brokenBound(parameter: Parameter, value: number, angles: AngleUnit): string | null {
  const { factor, unit } = shown(parameter.unit, angles);
  const words = (relation: string, bound: number): string => `${relation} ${plain(bound * factor)} ${unit}`.trim();
  const { exclusive_minimum: above, minimum, maximum } = parameter;
  if (typeof above === "number" && value <= above) return words("must be greater than", above);
  if (typeof minimum === "number" && value < minimum) return words("must be at least", minimum);
  if (typeof maximum === "number" && value > maximum) return words("must be at most", maximum);
  return null;
}

/** Bounds in words, such as "above 0, up to 100 kg". */
export function boundsText(parameter: Parameter, angles: AngleUnit): string {
  const { factor, unit } = shown(parameter.unit, angles);
  const { exclusive_minimum: above, minimum, maximum, fewest, most } = parameter;
  const parts: string[] = [];
  if (typeof fewest === "number" && typeof most === "number") parts.push(`${fewest} to ${most} points`);
  if (typeof above === "number") parts.push(`above ${plain(above * factor)}`);
  if (typeof minimum === "number") parts.push(`from ${plain(minimum * factor)}`);
  if (typeof maximum === "number") parts.push(`up to ${plain(maximum * factor)}`);
  return parts.length === 0 ? "none" : `${parts.join(", ")} ${unit}`.trim();
}

const isEntry = (value: unknown): value is Draft[string] =>
  typeof value === "object" && value !== null && "text" in value && typeof value.text === "string" && "angles" in value && (value.angles === "rad" || value.angles === "deg");

/** A draft that was kept; what is none is left out. */
export const readDraft = (kept: unknown): Draft =>
  typeof kept === "object" && kept !== null ? Object.fromEntries(Object.entries(kept).filter((entry): entry is [string, Draft[string]] => isEntry(entry[1]))) : {};

/** What takes changes back: each value that is still as they made it. */
export const undoOf = (changes: readonly Change[], config: unknown): Change[] =>
  changes.flatMap(({ parameter, from, to }) => {
    const present = valueAt(config, parameter.path);
    return present !== undefined && equal(present, to) ? [{ parameter, from: to, to: from }] : [];
  });

const DISPLAY_PRECISION = 1e-6;

/** Equal for a person: what a field shows of a value and what it means again differ by rounding alone. */
function equal(one: Value, other: Value): boolean {
  if (isPoints(one) && isPoints(other)) return one.length === other.length && one.flat().every((each, place) => equal(each, other.flat()[place] ?? NaN));
  if (typeof one !== "number" || typeof other !== "number") return one === other;
  return Math.abs(one - other) <= DISPLAY_PRECISION * Math.max(Math.abs(one), Math.abs(other));
}

/** The staged edits that are sound and differ from what is in force. */
export function changesOf(draft: Draft, parameters: readonly Parameter[], config: unknown): Change[] {
  return parameters.flatMap((parameter) => {
    const entry = draft[parameter.path];
    const from = valueAt(config, parameter.path);
    if (entry === undefined || from === undefined) return [];
    const meant = meaning(parameter, entry.text, entry.angles);
    return "value" in meant && !equal(from, meant.value) ? [{ parameter, from, to: meant.value }] : [];
  });
}

/** The draft without that field if it says what is in force anyway; asked when a person leaves the field. */
export function settled(draft: Draft, parameter: Parameter, config: unknown): Draft {
  const entry = draft[parameter.path];
  const value = valueAt(config, parameter.path);
  const meant = entry && meaning(parameter, entry.text, entry.angles);
  if (value === undefined || meant === undefined || "error" in meant || !equal(value, meant.value)) return draft;
  return Object.fromEntries(Object.entries(draft).filter(([path]) => path !== parameter.path));
}

/** The draft that makes one configuration of another: every value in which they differ. */
export function draftTowards(wanted: unknown, parameters: readonly Parameter[], config: unknown, angles: AngleUnit): Draft {
  const entries = parameters.flatMap((parameter): [string, Draft[string]][] => {
    const [value, present] = [valueAt(wanted, parameter.path), valueAt(config, parameter.path)];
    if (value === undefined || present === undefined || equal(value, present)) return [];
    return [[parameter.path, { text: fieldText(parameter, value, angles), angles }]];
  });
  return Object.fromEntries(entries);
}

/** The draft with these values, by full path, in place of what stood in their fields; one that is in force needs no edit. */
export function draftWith(draft: Draft, values: Readonly<Record<string, Value>>, parameters: readonly Parameter[], config: unknown, angles: AngleUnit): Draft {
  const rest = Object.entries(draft).filter(([path]) => !(path in values));
  const entries = parameters.flatMap((parameter): [string, Draft[string]][] => {
    const value = values[parameter.path];
    const present = valueAt(config, parameter.path);
    if (value === undefined || (present !== undefined && equal(value, present))) return [];
    return [[parameter.path, { text: fieldText(parameter, value, angles), angles }]];
  });
  return Object.fromEntries([...rest, ...entries]);
}

/** The staged fields that cannot be sent as they stand. */
export function unsoundFields(draft: Draft, parameters: readonly Parameter[]): Parameter[] {
  return parameters.filter((parameter) => {
    const entry = draft[parameter.path];
    return entry !== undefined && "error" in meaning(parameter, entry.text, entry.angles);
  });
}

/** The changes as the nested body that the service takes. */
export const patchOf = (changes: readonly Change[]): Record<string, unknown> =>
  nested(changes.map(({ parameter, to }): [string, unknown] => [parameter.path, to]));

/** Values by full path as a tree. */
export function nested(values: readonly (readonly [string, unknown])[]): Record<string, unknown> {
  const body: Record<string, unknown> = {};
  for (const [path, to] of values) {
    const groups = path.split(".");
    const leaf = groups.pop() ?? "";
    let branch = body;
    for (const group of groups) branch = (branch[group] ??= {}) as Record<string, unknown>;
    branch[leaf] = to;
  }
  return body;
}

/** The next value for an arrow key: one unit of the second digit, so 0.10 goes to 0.11 and 10 to 11. */
export function nudged(text: string, direction: 1 | -1): string {
  const read = readNumber(text);
  if ("error" in read) return text;
  const { value } = read;
  const step = value === 0 ? 0.1 : 10 ** (Math.floor(Math.log10(Math.abs(value)) + 1e-9) - 1);
  return plain(value + direction * step);
}

/** A name of the configuration as words: `hand_tilt` is "Hand tilt". */
export function words(name: string): string {
  const spaced = methodWords(name);
  return spaced.charAt(0).toUpperCase() + spaced.slice(1);
}

/** Parameters whose path, words or source hold every word that was searched for. */
export function found(parameters: readonly Parameter[], query: string): Parameter[] {
  const wanted = query.toLowerCase().split(/\s+/).filter(Boolean);
  return parameters.filter((parameter) => {
    const text = `${parameter.path} ${words(parameter.path)} ${Object.values(parameter.choice_titles).join(" ")} ${parameter.title} ${parameter.group_title} ${parameter.description} ${parameter.source}`.toLowerCase();
    return wanted.every((word) => text.includes(word));
  });
}

/** Edits that are staged but not yet applied: pure functions from what was typed to what would be sent. */
import type { Parameter } from "../../api/types";
import { readNumber, readWhole } from "../../units/numbers";
import { plain, shown, type AngleUnit } from "../../units/units";

export type Value = number | string;

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
  return typeof branch === "number" || typeof branch === "string" ? branch : undefined;
}

/** How a value stands in its field. */
export function fieldText(parameter: Parameter, value: Value, angles: AngleUnit): string {
  return typeof value === "number" ? plain(value * shown(parameter.unit, angles).factor) : value;
}

/** What the field means in SI, or what is wrong with it. */
export function meaning(parameter: Parameter, text: string, angles: AngleUnit): { value: Value } | { error: string } {
  if (parameter.choices) return { value: text };
  const typed = parameter.type === "integer" ? readWhole(text) : readNumber(text);
  if ("error" in typed) return typed;
  const value = typed.value / shown(parameter.unit, angles).factor;
  const broken = brokenBound(parameter, value, angles);
  return broken === null ? { value } : { error: broken };
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
  const { exclusive_minimum: above, minimum, maximum } = parameter;
  const parts: string[] = [];
  if (typeof above === "number") parts.push(`above ${plain(above * factor)}`);
  if (typeof minimum === "number") parts.push(`from ${plain(minimum * factor)}`);
  if (typeof maximum === "number") parts.push(`up to ${plain(maximum * factor)}`);
  return parts.length === 0 ? "none" : `${parts.join(", ")} ${unit}`.trim();
}

const DISPLAY_PRECISION = 1e-6;

/** Equal for a person: what a field shows of a value and what it means again differ by rounding alone. */
function equal(one: Value, other: Value): boolean {
  if (typeof one === "string" || typeof other === "string") return one === other;
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
  const spaced = name.replaceAll("_", " ");
  return spaced.charAt(0).toUpperCase() + spaced.slice(1);
}

/** Parameters whose path, words or source hold every word that was searched for. */
export function found(parameters: readonly Parameter[], query: string): Parameter[] {
  const wanted = query.toLowerCase().split(/\s+/).filter(Boolean);
  return parameters.filter((parameter) => {
    const text = `${parameter.path} ${words(parameter.path)} ${parameter.title} ${parameter.group_title} ${parameter.description} ${parameter.source}`.toLowerCase();
    return wanted.every((word) => text.includes(word));
  });
}

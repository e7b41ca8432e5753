/** A study as a person writes it in the form, and as the service takes it. */
import type { StudyRequest } from "../../api/types";
import { plainly, readList, readNumber, readWhole, type NumberRead } from "../../units/numbers";

export interface AxisDraft {
  readonly path: string;
  /** `0.1, 0.2` or `0 .. 15 by 1.5` or `0 .. 1 in 5` or `0.01 .. 1 in 5 log`. */
  readonly values: string;
}

export interface DrawDraft {
  readonly path: string;
  /** `0.5 .. 1.5` is uniform, `2.35 ± 0.1` normal. */
  readonly distribution: string;
}

export interface StudyDraft {
  readonly name: string;
  readonly configuration: string;
  readonly direct: boolean;
  readonly seed: string;
  readonly grid: readonly AxisDraft[];
  readonly draws: readonly DrawDraft[];
  readonly count: string;
  readonly method: string;
}

export const EMPTY_DRAFT: StudyDraft = {
  name: "",
  configuration: "published",
  direct: false,
  seed: "0",
  grid: [{ path: "published.impedance.damping", values: "0 .. 6 by 1.5" }],
  draws: [],
  count: "32",
  method: "latin_hypercube",
};

const areLines = (value: unknown, names: readonly string[]): boolean =>
  Array.isArray(value) && value.every((line: unknown) => typeof line === "object" && line !== null && names.every((name) => typeof (line as Record<string, unknown>)[name] === "string"));

/** A draft that was kept, if it is a whole one; else an empty one. */
export function readKeptDraft(kept: unknown): StudyDraft {
  if (typeof kept !== "object" || kept === null) return EMPTY_DRAFT;
  const draft = kept as Record<string, unknown>;
  const texts = ["name", "configuration", "seed", "count", "method"].every((name) => typeof draft[name] === "string");
  const whole = texts && typeof draft["direct"] === "boolean" && areLines(draft["grid"], ["path", "values"]) && areLines(draft["draws"], ["path", "distribution"]);
  return whole ? (kept as StudyDraft) : EMPTY_DRAFT;
}

/** Where in the form something cannot be read: `grid 0` is the first line of the grid. */
export type Place = `grid ${number}` | `draws ${number}` | "count" | "seed" | "lines";

/** What a draft says: a request, or what to correct and where. */
export interface DraftRead {
  readonly request: StudyRequest | null;
  readonly faults: ReadonlyMap<Place, string>;
}

type Read<What> = { readonly is: What } | { readonly error: string };

const RANGE = /^(.*?\S)\s*\.\.\s*(.*?)(?:\s+(by|in)\s+(.*?))?(\s+log)?$/i;
const HOW_DIVIDED = 'say how the range is divided: "by 0.5" or "in 5"';

/** The first of these that cannot be read. */
const firstError = (...reads: readonly NumberRead[]): string | null => reads.map((read) => ("error" in read ? read.error : null)).find((error) => error !== null) ?? null;

const valueOf = (read: NumberRead): number => ("value" in read ? read.value : Number.NaN);

/** A range as the service takes it. */
function rangeOf([, from = "", to = "", kind, amount = "", log]: readonly string[]): Read<unknown> {
  const counted = kind?.toLowerCase() === "in";
  const ends = [readNumber(from), readNumber(to)] as const;
  const error = firstError(...ends);
  if (error !== null) return { error };
  if (kind === undefined) return { error: HOW_DIVIDED };
  const part = counted ? readWhole(amount) : readNumber(amount);
  if ("error" in part) return part;
  if (log !== undefined && !counted) return { error: 'a logarithmic range is divided by a count: "0.01 .. 1 in 5 log"' };
  const [low, high] = [valueOf(ends[0]), valueOf(ends[1])];
  if (high < low) return { error: `the range ends below its beginning; write ${to} .. ${from}` };
  if (part.value <= 0) return { error: counted ? "a range has at least one value" : "the step must be greater than 0" };
  const divided = counted ? { count: part.value } : { step: part.value };
  return { is: { from: low, to: high, ...divided, ...(log === undefined ? {} : { spacing: "logarithmic" }) } };
}

/** The values of a grid's line. */
export function axisOf(values: string): Read<unknown> {
  const range = RANGE.exec(plainly(values));
  if (range !== null) return rangeOf(range);
  const list = readList(values);
  return "error" in list ? list : { is: list.values };
}

/** The distribution of a line of draws. */
export function distributionOf(distribution: string): Read<unknown> {
  const text = plainly(distribution).replace("+/-", "±");
  const parts = text.split("±");
  if (parts.length === 2) {
    const [mean, deviation] = [readNumber(parts[0] ?? ""), readNumber(parts[1] ?? "")];
    const error = firstError(mean, deviation);
    return error === null ? { is: { mean: valueOf(mean), deviation: valueOf(deviation) } } : { error };
  }
  const range = RANGE.exec(text);
  if (range === null || range[3] !== undefined) return { error: 'write "0.5 .. 1.5" for uniform draws, or "2.35 ± 0.1" for normal ones' };
  const [from, to] = [readNumber(range[1] ?? ""), readNumber(range[2] ?? "")];
  const error = firstError(from, to);
  return error === null ? { is: { from: valueOf(from), to: valueOf(to), ...(range[5] === undefined ? {} : { spacing: "logarithmic" }) } } : { error };
}

interface Line {
  readonly place: Place;
  /** As a person finds it: "line 2 of the grid". */
  readonly words: string;
  readonly path: string;
  readonly text: string;
  readonly read: (text: string) => Read<unknown>;
}

/** The lines with something in them; an empty one is as good as none. */
function linesOf({ grid, draws }: StudyDraft): Line[] {
  const lines = [
    ...grid.map(({ path, values }, at): Line => ({ place: `grid ${at}`, words: `line ${at + 1} of the grid`, path: path.trim(), text: values, read: axisOf })),
    ...draws.map(({ path, distribution }, at): Line => ({ place: `draws ${at}`, words: `line ${at + 1} of the draws`, path: path.trim(), text: distribution, read: distributionOf })),
  ];
  return lines.filter(({ path, text }) => path !== "" || text.trim() !== "");
}

/** What of a line does not stand beside the lines before it, or by itself. */
function faultOf(line: Line, before: readonly Line[]): string | null {
  if (line.path === "") return "the parameter is missing";
  const same = before.find((other) => other.path === line.path);
  if (same !== undefined) return `${line.path} stands in ${same.words} already; write all of its values in one line`;
  const read = line.read(line.text);
  return "error" in read ? read.error : null;
}

function faultsOf(draft: StudyDraft, lines: readonly Line[]): Map<Place, string> {
  const faults = new Map<Place, string>();
  lines.forEach((line, at) => {
    const fault = faultOf(line, lines.slice(0, at));
    if (fault !== null) faults.set(line.place, fault);
  });
  if (lines.length === 0) faults.set("lines", "the study varies nothing yet; name a parameter and its values");
  const numbers: [Place, string][] = [["seed", draft.seed], ...(lines.some(isDrawn) ? [["count", draft.count] as [Place, string]] : [])];
  for (const [place, text] of numbers) {
    const read = readWhole(text);
    if ("error" in read) faults.set(place, read.error);
    else if (read.value < (place === "count" ? 1 : 0)) faults.set(place, place === "count" ? "draw at least one" : "a seed is not negative");
  }
  return faults;
}

const isDrawn = ({ place }: Line): boolean => place.startsWith("draws");

/** What lines of one kind say, by the path of each. */
const byPath = (lines: readonly Line[]): Record<string, unknown> =>
  Object.fromEntries(
    lines.map((line) => {
      const read = line.read(line.text);
      return [line.path, "is" in read ? read.is : null];
    }),
  );

/** The request that starts this study, or what to correct; what cannot be flown is the service's to refuse. */
export function readDraft(draft: StudyDraft, confirm = false): DraftRead {
  const lines = linesOf(draft);
  const faults = faultsOf(draft, lines);
  if (faults.size > 0) return { request: null, faults };
  const over = byPath(lines.filter(isDrawn));
  const samples = { method: draft.method, count: valueOf(readWhole(draft.count)), over };
  const study = {
    name: draft.name.trim() === "" ? "study" : draft.name.trim(),
    configuration: draft.configuration,
    direct: draft.direct,
    grid: byPath(lines.filter((line) => !isDrawn(line))),
    ...(Object.keys(over).length > 0 ? { samples } : {}),
  };
  return { request: { study, changes: {}, seed: valueOf(readWhole(draft.seed)), confirm }, faults };
}

/** Settings by full path as the nested changes that the service takes. */
export function nested(flat: Readonly<Record<string, unknown>>): Record<string, unknown> {
  const tree: Record<string, unknown> = {};
  for (const [path, value] of Object.entries(flat)) {
    const names = path.split(".");
    const last = names.pop() ?? path;
    let branch = tree;
    for (const name of names) branch = (branch[name] ??= {}) as Record<string, unknown>;
    branch[last] = value;
  }
  return tree;
}

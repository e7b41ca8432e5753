/** A study as a person writes it in the form, and as the service takes it. */
import type { StudyRequest } from "../../api/types";
import { parsed } from "../../units/units";

export interface AxisDraft {
  readonly path: string;
  /** `0.1, 0.2` or `0 .. 15 by 1.5` or `0 .. 1 in 5`. */
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
  grid: [{ path: "control.impedance.damping", values: "0 .. 6 by 1.5" }],
  draws: [],
  count: "32",
  method: "latin_hypercube",
};

/** What cannot be read of a draft, and where. */
export class DraftError extends Error {}

const RANGE = /^(.+?)\s*\.\.\s*(.+?)(?:\s+(by|in)\s+(.+))?$/;

function numberIn(text: string, where: string): number {
  const value = parsed(text);
  if (value === null) throw new DraftError(`${where}: "${text}" is no number`);
  return value;
}

function axisOf({ path, values }: AxisDraft): unknown {
  const range = RANGE.exec(values.trim());
  if (range === null) return values.split(",").map((each) => parsed(each) ?? each.trim());
  const [, from = "", to = "", kind, amount = ""] = range;
  const ends = { from: numberIn(from, path), to: numberIn(to, path) };
  if (kind === undefined) throw new DraftError(`${path}: say how the range is divided, "by 0.5" or "in 5"`);
  return kind === "by" ? { ...ends, step: numberIn(amount, path) } : { ...ends, count: numberIn(amount, path) };
}

function distributionOf({ path, distribution }: DrawDraft): unknown {
  const [mean, deviation] = distribution.split("±");
  if (mean !== undefined && deviation !== undefined) {
    return { mean: numberIn(mean, path), deviation: numberIn(deviation, path) };
  }
  const range = RANGE.exec(distribution.trim());
  if (range === null) throw new DraftError(`${path}: write "0.5 .. 1.5" for uniform draws, or "2.35 ± 0.1" for normal ones`);
  return { from: numberIn(range[1] ?? "", path), to: numberIn(range[2] ?? "", path) };
}

/** The request that starts this study.

    Throws a `DraftError` for what cannot be read; what cannot be flown is the service's to refuse. */
export function requestOf(draft: StudyDraft, confirm: boolean): StudyRequest {
  const grid = Object.fromEntries(draft.grid.map((axis) => [axis.path, axisOf(axis)]));
  const over = Object.fromEntries(draft.draws.map((draw) => [draw.path, distributionOf(draw)]));
  const samples = { method: draft.method, count: numberIn(draft.count, "count"), over };
  const study = {
    name: draft.name.trim() === "" ? "study" : draft.name.trim(),
    configuration: draft.configuration,
    direct: draft.direct,
    grid,
    ...(draft.draws.length > 0 ? { samples } : {}),
  };
  return { study, changes: {}, seed: numberIn(draft.seed, "seed"), confirm };
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

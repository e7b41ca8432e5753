/** How two runs differ: pure functions from two runs to the lines of a table. */
import type { Outcome, Parameter, Run } from "../../api/types";
import { classStyle } from "../glossary/class-style";
import { isPoints, pointsText } from "../../units/points";
import { clock, duration, fixed, MILLIMETRES, plain, shown } from "../../units/units";

export interface Line {
  readonly name: string;
  /** Of a parameter, its full path. */
  readonly path?: string;
  readonly one: string;
  readonly other: string;
}

const ofOutcome = (run: Run, read: (outcome: Outcome) => string): string => (run.outcome === null ? "—" : read(run.outcome));

const FIGURES: readonly (readonly [string, (run: Run) => string])[] = [
  ["Verdict", (run) => ofOutcome(run, (outcome) => classStyle(outcome.outcome).words)],
  ["Paper's verdict (at first closure)", (run) => ofOutcome(run, (outcome) => classStyle(outcome.at_first_closure).words)],
  ["Touches", (run) => ofOutcome(run, (outcome) => String(outcome.contacts.length))],
  ["Closed at", (run) => ofOutcome(run, ({ closed_at: at }) => (at === null ? "never" : clock(at, 2)))],
  ["Peak to closure, N", (run) => ofOutcome(run, (outcome) => fixed(outcome.peak_tip_force_to_closure, 3))],
  ["Peak to locked arms, N", (run) => ofOutcome(run, (outcome) => fixed(outcome.peak_tip_force, 3))],
  ["Cage margin, mm", (run) => ofOutcome(run, ({ cage_margin: margin }) => (margin === null ? "none" : fixed(margin * MILLIMETRES.factor, 1)))],
  ["Final spin, rad/s", (run) => ofOutcome(run, (outcome) => fixed(outcome.final_target_spin, 3))],
  ["Duration", (run) => duration(run.duration, 2)],
];

/** What came of both. */
export const figures = (one: Run, other: Run): Line[] => FIGURES.map(([name, read]) => ({ name, one: read(one), other: read(other) }));

/** Every value of a nested configuration by its full path. */
function leaves(branch: unknown, path: string): [string, string][] {
  if (isPoints(branch)) return [[path, pointsText(branch)]];
  if (typeof branch !== "object" || branch === null) return [[path, typeof branch === "number" ? plain(branch) : String(branch)]];
  return Object.entries(branch).flatMap(([name, value]) => leaves(value, path === "" ? name : `${path}.${name}`));
}

/** Changed parameters, by full path. */
export function choices(one: Run, other: Run): Line[] {
  const others = new Map(leaves(other.config, ""));
  return leaves(one.config, "").flatMap(([name, value]) => {
    const theirs = others.get(name) ?? "—";
    return theirs === value ? [] : [{ name, one: value, other: theirs }];
  });
}

/** The same with each parameter called as on its form, with its unit; one that the service does not know keeps its path. */
export function named(lines: readonly Line[], parameters: readonly Pick<Parameter, "path" | "title" | "unit">[]): Line[] {
  const known = new Map(parameters.map((parameter) => [parameter.path, parameter]));
  return lines.map((line) => {
    const parameter = known.get(line.name);
    if (parameter === undefined) return line;
    const { unit } = shown(parameter.unit, "rad");
    return { ...line, name: unit === "" ? parameter.title : `${parameter.title}, ${unit}`, path: line.name };
  });
}

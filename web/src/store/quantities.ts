/** What the console keeps over time, and where each quantity comes from: a snapshot or a row of the history. */
import type { MissionSnapshot } from "../api/types";
import { phaseCode } from "./phases";

/** Reads one column of a history row by its name; NaN if the history has no such column. */
export type Cell = (name: string) => number;

interface Quantity {
  readonly ofSnapshot: (snapshot: MissionSnapshot) => number;
  readonly ofRow: (cell: Cell) => number;
}

export const QUANTITY_NAMES = [
  "tick",
  "time",
  "phase",
  "leftForce",
  "rightForce",
  "spin",
  "baseRate",
  "baseAngle",
  "leftManipulability",
  "rightManipulability",
] as const;
export type QuantityName = (typeof QUANTITY_NAMES)[number];

export const QUANTITIES: Readonly<Record<QuantityName, Quantity>> = {
  tick: { ofSnapshot: (s) => s.tick, ofRow: (cell) => cell("mission.tick") },
  time: { ofSnapshot: (s) => s.time, ofRow: (cell) => cell("mission.time") },
  phase: { ofSnapshot: (s) => phaseCode(s.phase), ofRow: (cell) => cell("mission.phase") },
  leftForce: {
    ofSnapshot: (s) => Math.hypot(s.left.hand_wrench[0], s.left.hand_wrench[1]),
    ofRow: (cell) => Math.hypot(cell("left.hand_wrench.x"), cell("left.hand_wrench.y")),
  },
  rightForce: {
    ofSnapshot: (s) => Math.hypot(s.right.hand_wrench[0], s.right.hand_wrench[1]),
    ofRow: (cell) => Math.hypot(cell("right.hand_wrench.x"), cell("right.hand_wrench.y")),
  },
  spin: { ofSnapshot: (s) => s.spin, ofRow: (cell) => cell("target.twist.angle") },
  baseRate: { ofSnapshot: (s) => s.base.twist[2], ofRow: (cell) => cell("base.twist.angle") },
  baseAngle: { ofSnapshot: (s) => s.base.pose[2], ofRow: (cell) => cell("base.pose.angle") },
  leftManipulability: { ofSnapshot: (s) => s.left.manipulability, ofRow: (cell) => cell("left.manipulability") },
  rightManipulability: { ofSnapshot: (s) => s.right.manipulability, ofRow: (cell) => cell("right.manipulability") },
};

export type Sample = Readonly<Record<QuantityName, number>>;

function sample(read: (quantity: Quantity) => number): Sample {
  return Object.fromEntries(QUANTITY_NAMES.map((name) => [name, read(QUANTITIES[name])])) as Record<QuantityName, number>;
}

export const sampleOfSnapshot = (snapshot: MissionSnapshot): Sample => sample((quantity) => quantity.ofSnapshot(snapshot));

export interface Table {
  readonly columns: readonly { readonly name: string }[];
  readonly rows: readonly (readonly (number | null)[])[];
}

/** The samples of a history, oldest first. */
export function samplesOfTable(table: Table): Sample[] {
  const places = new Map(table.columns.map((column, place) => [column.name, place]));
  return table.rows.map((row) => {
    const cell: Cell = (name) => row[places.get(name) ?? -1] ?? Number.NaN;
    return sample((quantity) => quantity.ofRow(cell));
  });
}

/** The columns of the log by their names (docs/logs.md), wherever a value is told: in a row of a table, or in a live snapshot. */
import type { MissionSnapshot } from "../api/types";
import { phaseCode } from "./phases";

/** Reads a column by its name; NaN if there is none, or nothing was recorded there. */
export type Column = (name: string) => number;

export interface Table {
  readonly columns: readonly { readonly name: string }[];
  readonly rows: readonly (readonly (number | null)[])[];
}

/** One reader for each row of a table. */
export function columnsOfTable({ columns, rows }: Table): Column[] {
  const places = new Map(columns.map((column, place) => [column.name, place]));
  return rows.map((row) => (name) => row[places.get(name) ?? -1] ?? Number.NaN);
}

/** Axes of poses, twists and wrenches, and the joints, by their places. */
const PLACES: Readonly<Record<string, number>> = { x: 0, y: 1, angle: 2, torque: 2, "1": 0, "2": 1, "3": 2 };

type Bodies = Pick<MissionSnapshot, "left" | "right" | "base" | "target">;

const isBody = (group: string): group is keyof Bodies => ["left", "right", "base", "target"].includes(group);

/** What the service derives of an arm for plots, derived likewise (server/library/plotted.py). */
const DERIVED: Readonly<Record<string, (arm: Column) => number>> = {
  hand_force: (arm) => Math.hypot(arm("hand_wrench.x"), arm("hand_wrench.y")),
  position_error: (arm) => Math.hypot(arm("desired_hand_pose.x") - arm("hand_pose.x"), arm("desired_hand_pose.y") - arm("hand_pose.y")),
  angle_error: (arm) => arm("desired_hand_pose.angle") - arm("hand_pose.angle"),
};

function valueIn(body: Readonly<Record<string, unknown>>, name: string): number {
  const derived = DERIVED[name];
  if (derived !== undefined) return derived((inner) => valueIn(body, inner));
  const [quantity = "", axis] = name.split(".");
  const value: unknown = body[quantity];
  const element: unknown = axis !== undefined && Array.isArray(value) ? value[PLACES[axis] ?? -1] : value;
  return typeof element === "number" ? element : Number.NaN;
}

/** Reads a live snapshot by the names that its values have in the log. */
export function columnsOfSnapshot(snapshot: MissionSnapshot): Column {
  const mission = { tick: snapshot.tick, time: snapshot.time, phase: phaseCode(snapshot.phase) };
  return (name) => {
    const [group = ""] = name.split(".", 1);
    const rest = name.slice(group.length + 1);
    if (group === "mission") return valueIn(mission, rest);
    return isBody(group) ? valueIn(snapshot[group], rest) : Number.NaN;
  };
}

/**
 * What the console keeps over time and plots. A quantity is one entry: its name, its SI unit, and an expression over
 * columns of the log, by which live snapshots, histories and stored runs are read alike.
 */
import type { MissionSnapshot } from "../api/types";
import { columnsOfSnapshot, columnsOfTable, type Column, type Table } from "./columns";

export interface Quantity {
  readonly unit: string;
  readonly of: (column: Column) => number;
}

/** A quantity that a single column of the log holds. */
const column = (name: string, unit: string): Quantity => ({ unit, of: (value) => value(name) });

/** One that is zero while nothing is asked for: no curve then. */
const asked = (name: string, unit: string): Quantity => ({ unit, of: (value) => (value(name) > 0 ? value(name) : Number.NaN) });

export const QUANTITIES = {
  tick: column("mission.tick", "1"),
  time: column("mission.time", "s"),
  phase: column("mission.phase", "1"),
  spin: column("target.twist.angle", "rad/s"),
  baseRate: column("base.twist.angle", "rad/s"),
  baseAngle: column("base.pose.angle", "rad"),
  leftForce: column("left.hand_force", "N"),
  rightForce: column("right.hand_force", "N"),
  leftWantedForce: asked("left.wanted_force", "N"),
  rightWantedForce: asked("right.wanted_force", "N"),
  leftManipulability: column("left.manipulability", "m2"),
  rightManipulability: column("right.manipulability", "m2"),
  leftPositionError: column("left.position_error", "m"),
  rightPositionError: column("right.position_error", "m"),
  leftAngleError: column("left.angle_error", "rad"),
  rightAngleError: column("right.angle_error", "rad"),
  leftJointRate1: column("left.joint_rate.1", "rad/s"),
  leftJointRate2: column("left.joint_rate.2", "rad/s"),
  leftJointRate3: column("left.joint_rate.3", "rad/s"),
  rightJointRate1: column("right.joint_rate.1", "rad/s"),
  rightJointRate2: column("right.joint_rate.2", "rad/s"),
  rightJointRate3: column("right.joint_rate.3", "rad/s"),
  leftCommandedJointRate1: column("left.commanded_joint_rate.1", "rad/s"),
  leftCommandedJointRate2: column("left.commanded_joint_rate.2", "rad/s"),
  leftCommandedJointRate3: column("left.commanded_joint_rate.3", "rad/s"),
  rightCommandedJointRate1: column("right.commanded_joint_rate.1", "rad/s"),
  rightCommandedJointRate2: column("right.commanded_joint_rate.2", "rad/s"),
  rightCommandedJointRate3: column("right.commanded_joint_rate.3", "rad/s"),
} as const satisfies Record<string, Quantity>;

export type QuantityName = keyof typeof QUANTITIES;
export const QUANTITY_NAMES = Object.keys(QUANTITIES) as readonly QuantityName[];

/** The value of every quantity at one tick. */
export type Sample = Readonly<Record<QuantityName, number>>;

const sampleOf = (value: Column): Sample =>
  Object.fromEntries(QUANTITY_NAMES.map((name) => [name, QUANTITIES[name].of(value)])) as Record<QuantityName, number>;

export const sampleOfSnapshot = (snapshot: MissionSnapshot): Sample => sampleOf(columnsOfSnapshot(snapshot));

/** The samples of a history, oldest first. */
export const samplesOfTable = (table: Table): Sample[] => columnsOfTable(table).map(sampleOf);

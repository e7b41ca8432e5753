import { describe, expect, it } from "vitest";
import type { MissionSnapshot } from "../api/types";
import { QUANTITIES, QUANTITY_NAMES, sampleOfSnapshot, samplesOfTable, type QuantityName } from "./quantities";

const arm = (by: number) => ({
  joint_rate: [by + 0.1, by + 0.2, by + 0.3],
  commanded_joint_rate: [by + 0.4, by + 0.5, by + 0.6],
  hand_wrench: [3 * by, 4 * by, 99],
  hand_pose: [1, 2, 0.5],
  desired_hand_pose: [1 + 0.3 * by, 2 - 0.4 * by, 0.5 - 0.1 * by],
  manipulability: 0.01 * by,
  wanted_force: 0.2 * by,
});

const SNAPSHOT = {
  tick: 1200,
  time: 1.2,
  phase: "caging",
  left: arm(1),
  right: arm(2),
  base: { pose: [0, 0, 0.02], twist: [0, 0, -0.03] },
  target: { pose: [0, 0, 0.7], twist: [0, 0, 0.6] },
} as unknown as MissionSnapshot;

/** What the service says of the same tick, by the columns of its history. */
const COLUMNS: Readonly<Record<string, number>> = {
  "mission.tick": 1200,
  "mission.time": 1.2,
  "mission.phase": 2,
  "target.twist.angle": 0.6,
  "base.twist.angle": -0.03,
  "base.pose.angle": 0.02,
  "left.hand_force": 5,
  "right.hand_force": 10,
  "left.wanted_force": 0.2,
  "right.wanted_force": 0.4,
  "left.manipulability": 0.01,
  "right.manipulability": 0.02,
  "left.position_error": 0.5,
  "right.position_error": 1,
  "left.angle_error": -0.1,
  "right.angle_error": -0.2,
  "left.joint_rate.1": 1.1,
  "left.joint_rate.2": 1.2,
  "left.joint_rate.3": 1.3,
  "right.joint_rate.1": 2.1,
  "right.joint_rate.2": 2.2,
  "right.joint_rate.3": 2.3,
  "left.commanded_joint_rate.1": 1.4,
  "left.commanded_joint_rate.2": 1.5,
  "left.commanded_joint_rate.3": 1.6,
  "right.commanded_joint_rate.1": 2.4,
  "right.commanded_joint_rate.2": 2.5,
  "right.commanded_joint_rate.3": 2.6,
};

describe("a plotted quantity", () => {
  const live = sampleOfSnapshot(SNAPSHOT);
  const [stored] = samplesOfTable({ columns: Object.keys(COLUMNS).map((name) => ({ name })), rows: [Object.values(COLUMNS)] });

  it.each(QUANTITY_NAMES)("%s is the same of a live snapshot and of a stored tick", (name) => {
    expect(live[name]).toBeCloseTo(stored?.[name] ?? Number.NaN, 12);
  });

  it("may be any expression over columns", () => {
    const difference = { unit: "N", of: (value: (name: string) => number) => value("left.hand_force") - value("right.hand_force") };
    expect(difference.of((name) => COLUMNS[name] ?? Number.NaN)).toBe(-5);
  });

  it("has its SI unit", () => {
    const units: Partial<Record<QuantityName, string>> = { leftForce: "N", spin: "rad/s", baseAngle: "rad", leftPositionError: "m", rightManipulability: "m2" };
    for (const [name, unit] of Object.entries(units)) expect(QUANTITIES[name as QuantityName].unit).toBe(unit);
  });

  it("is NaN where a table lacks its column, or nothing was recorded", () => {
    const [row] = samplesOfTable({ columns: ["mission.tick", "right.hand_force", "left.hand_force"].map((name) => ({ name })), rows: [[7, null, 5]] });
    expect(row?.tick).toBe(7);
    expect(row?.leftForce).toBe(5);
    expect(row?.rightForce).toBeNaN();
    expect(row?.spin).toBeNaN();
  });
});

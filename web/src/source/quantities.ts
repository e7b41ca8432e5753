/** What the console keeps over time, and where each quantity comes from: a snapshot or a row of the history. */
import type { MissionSnapshot } from "../api/types";
import { phaseCode } from "./phases";

/** Reads one column of a history row by its name; NaN if it has none, or nothing was recorded there. */
export type Cell = (name: string) => number;

interface Quantity {
  readonly ofSnapshot: (snapshot: MissionSnapshot) => number;
  readonly ofRow: (cell: Cell) => number;
}

export const ARMS = ["left", "right"] as const;
export const JOINTS = [1, 2, 3] as const;
type Arm = (typeof ARMS)[number];
type Joint = (typeof JOINTS)[number];

export type ArmQuantityName =
  | `${Arm}JointRate${Joint}`
  | `${Arm}CommandedJointRate${Joint}`
  | `${Arm}PositionError`
  | `${Arm}AngleError`;

const ARM_QUANTITY_NAMES: readonly ArmQuantityName[] = ARMS.flatMap((arm) => [
  ...JOINTS.flatMap((joint) => [`${arm}JointRate${joint}`, `${arm}CommandedJointRate${joint}`] as const),
  `${arm}PositionError` as const,
  `${arm}AngleError` as const,
]);

const FIRST_NAMES = [
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

export type QuantityName = (typeof FIRST_NAMES)[number] | ArmQuantityName;
export const QUANTITY_NAMES: readonly QuantityName[] = [...FIRST_NAMES, ...ARM_QUANTITY_NAMES];

type Pose = readonly [number, number, number];

const distance = (one: Pose, other: Pose): number => Math.hypot(one[0] - other[0], one[1] - other[1]);

/** Of one arm: rates of its joints, and how far its hand is from where the plan wants it. */
function armQuantities(arm: Arm): [QuantityName, Quantity][] {
  const rates = JOINTS.flatMap((joint): [QuantityName, Quantity][] => [
    [`${arm}JointRate${joint}`, { ofSnapshot: (s) => s[arm].joint_rate[joint - 1] ?? Number.NaN, ofRow: (cell) => cell(`${arm}.joint_rate.${joint}`) }],
    [
      `${arm}CommandedJointRate${joint}`,
      {
        ofSnapshot: (s) => s[arm].commanded_joint_rate[joint - 1] ?? Number.NaN,
        ofRow: (cell) => cell(`${arm}.commanded_joint_rate.${joint}`),
      },
    ],
  ]);
  return [
    ...rates,
    [
      `${arm}PositionError`,
      {
        ofSnapshot: (s) => distance(s[arm].desired_hand_pose, s[arm].hand_pose),
        ofRow: (cell) => cell(`${arm}.position_error`),
      },
    ],
    [
      `${arm}AngleError`,
      {
        ofSnapshot: (s) => s[arm].desired_hand_pose[2] - s[arm].hand_pose[2],
        ofRow: (cell) => cell(`${arm}.angle_error`),
      },
    ],
  ];
}

const FIRST_QUANTITIES: Readonly<Record<(typeof FIRST_NAMES)[number], Quantity>> = {
  tick: { ofSnapshot: (s) => s.tick, ofRow: (cell) => cell("mission.tick") },
  time: { ofSnapshot: (s) => s.time, ofRow: (cell) => cell("mission.time") },
  phase: { ofSnapshot: (s) => phaseCode(s.phase), ofRow: (cell) => cell("mission.phase") },
  leftForce: {
    ofSnapshot: (s) => Math.hypot(s.left.hand_wrench[0], s.left.hand_wrench[1]),
    ofRow: (cell) => cell("left.hand_force"),
  },
  rightForce: {
    ofSnapshot: (s) => Math.hypot(s.right.hand_wrench[0], s.right.hand_wrench[1]),
    ofRow: (cell) => cell("right.hand_force"),
  },
  spin: { ofSnapshot: (s) => s.spin, ofRow: (cell) => cell("target.twist.angle") },
  baseRate: { ofSnapshot: (s) => s.base.twist[2], ofRow: (cell) => cell("base.twist.angle") },
  baseAngle: { ofSnapshot: (s) => s.base.pose[2], ofRow: (cell) => cell("base.pose.angle") },
  leftManipulability: { ofSnapshot: (s) => s.left.manipulability, ofRow: (cell) => cell("left.manipulability") },
  rightManipulability: { ofSnapshot: (s) => s.right.manipulability, ofRow: (cell) => cell("right.manipulability") },
};

export const QUANTITIES = {
  ...FIRST_QUANTITIES,
  ...Object.fromEntries(ARMS.flatMap(armQuantities)),
} as Readonly<Record<QuantityName, Quantity>>;

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

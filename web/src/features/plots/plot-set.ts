/** Which plots there are: their curves, levels and ranges. A new plot is a new entry here. */
import type { MissionConfiguration, MissionSnapshot } from "../../api/types";
import { QUANTITIES, type QuantityName } from "../../source/quantities";
import { MILLIMETRES, type Shown } from "../../units/units";

export interface Curve {
  readonly quantity: QuantityName;
  /** Empty for a curve that belongs to the one before it: its value stands behind that one's. */
  readonly label: string;
  /** Colour token of `tokens.css`. */
  readonly token: string;
  /** A second sign beside the colour. */
  readonly dash?: readonly number[];
}

/** A value to compare with, such as a threshold. */
export interface Level {
  readonly label: string;
  readonly value: number;
}

export interface PlotDefinition {
  readonly id: string;
  readonly title: string;
  /** What its value axis shows, without the unit. */
  readonly axis: string;
  /** How a person reads it, where that is not the unit of its quantities. */
  readonly as?: Shown;
  readonly decimals: number;
  readonly curves: readonly Curve[];
  /** Marks the peak of each touch, which may lie between two samples. */
  readonly peaks?: boolean;
  /** The range it shows at least. */
  readonly least: readonly [number, number];
  readonly levels: (known: Known) => readonly Level[];
}

/** What levels are read from. */
export interface Known {
  readonly snapshot: MissionSnapshot | null;
  readonly config: MissionConfiguration["config"] | null;
}

/** The SI unit of a plot: all its quantities have the same. */
export const unitOf = ({ curves: [first] }: PlotDefinition): string => (first === undefined ? "1" : QUANTITIES[first.quantity].unit);

const JOINTS = [1, 2, 3] as const;
const JOINT_TOKENS = { 1: "left", 2: "right", 3: "target" } as const;

/** One quantity of both hands, told apart by colour and dash. */
const ofHands = (left: QuantityName, right: QuantityName): readonly Curve[] => [
  { quantity: left, label: "Left", token: "left" },
  { quantity: right, label: "Right", token: "right", dash: [7, 2] },
];

/** The commanded and the measured rate of each joint. */
const jointRates = (arm: "left" | "right"): PlotDefinition => ({
  id: `${arm}-joints`,
  title: `${arm === "left" ? "Left" : "Right"} joint rates, measured / commanded`,
  axis: "Joint rate",
  decimals: 3,
  curves: JOINTS.flatMap((joint) => [
    { quantity: `${arm}JointRate${joint}` as const, label: `J${joint}`, token: JOINT_TOKENS[joint] },
    { quantity: `${arm}CommandedJointRate${joint}` as const, label: "", token: JOINT_TOKENS[joint], dash: [2, 3] },
  ]),
  least: [-0.1, 0.1],
  levels: () => [],
});

const CONTACT: readonly PlotDefinition[] = [
  {
    id: "forces",
    title: "Tip force, felt / asked for",
    axis: "Force",
    decimals: 3,
    curves: [
      { quantity: "leftForce", label: "Left", token: "left" },
      { quantity: "leftWantedForce", label: "", token: "left", dash: [2, 3] },
      { quantity: "rightForce", label: "Right", token: "right", dash: [7, 2] },
      { quantity: "rightWantedForce", label: "", token: "right", dash: [2, 3] },
    ],
    peaks: true,
    least: [0, 0.6],
    levels: ({ config }) => (config ? [{ label: "direct caging", value: config.judging.force_bound }] : []),
  },
  {
    id: "rates",
    title: "Angular velocity",
    axis: "Angular velocity",
    decimals: 3,
    curves: [
      { quantity: "spin", label: "Target", token: "target" },
      { quantity: "baseRate", label: "Base", token: "base", dash: [7, 2] },
    ],
    least: [-0.1, 0.6],
    levels: ({ snapshot, config }) => {
      const chosen = config?.method === "published" ? config.published.caging.spin_threshold : null;
      const threshold = snapshot ? snapshot.spin_threshold : chosen;
      return threshold === null ? [] : [{ label: "threshold", value: threshold }];
    },
  },
];

const ROBOT: readonly PlotDefinition[] = [
  {
    id: "attitude",
    title: "Base attitude",
    axis: "Angle",
    decimals: 4,
    curves: [{ quantity: "baseAngle", label: "Base", token: "base" }],
    least: [-0.02, 0.02],
    levels: () => [],
  },
  {
    id: "manipulability",
    title: "Manipulability",
    axis: "Manipulability",
    decimals: 4,
    curves: ofHands("leftManipulability", "rightManipulability"),
    least: [0, 0.05],
    levels: ({ config }) => (config ? [{ label: "warning", value: config.control.rates.manipulability_warning }] : []),
  },
];

const TRACKING: readonly PlotDefinition[] = [
  {
    id: "position-error",
    title: "Hand position, distance from desired",
    axis: "Distance",
    as: MILLIMETRES,
    decimals: 2,
    curves: ofHands("leftPositionError", "rightPositionError"),
    least: [0, 1e-3],
    levels: () => [],
  },
  {
    id: "angle-error",
    title: "Hand angle, desired minus measured",
    axis: "Angle error",
    decimals: 4,
    curves: ofHands("leftAngleError", "rightAngleError"),
    least: [-0.01, 0.01],
    levels: () => [],
  },
];

/** What is shown together, above one another on one clock. */
export const PAIRS = {
  contact: { label: "Forces, spin", plots: CONTACT },
  robot: { label: "Attitude, manipulability", plots: ROBOT },
  joints: { label: "Joints", plots: [jointRates("left"), jointRates("right")] },
  tracking: { label: "Tracking", plots: TRACKING },
} as const satisfies Record<string, { readonly label: string; readonly plots: readonly PlotDefinition[] }>;

export type PairName = keyof typeof PAIRS;
export const PAIR_NAMES = Object.keys(PAIRS) as readonly PairName[];

/** On a wide screen two pairs stand beside one another. */
export const BESIDE: Readonly<Record<PairName, PairName>> = { contact: "robot", robot: "contact", joints: "tracking", tracking: "joints" };

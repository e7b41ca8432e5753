/** Which plots there are: their curves, levels and ranges. A new plot is a new entry here. */
import type { MissionConfiguration, MissionSnapshot } from "../../api/types";
import type { QuantityName } from "../../store/quantities";

export interface Curve {
  readonly quantity: QuantityName;
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
  /** SI unit of all its curves. */
  readonly unit: string;
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

export const PLOTS: readonly PlotDefinition[] = [
  {
    id: "forces",
    title: "Tip force, resultant of each hand",
    unit: "N",
    decimals: 3,
    curves: [
      { quantity: "leftForce", label: "Left", token: "left" },
      { quantity: "rightForce", label: "Right", token: "right", dash: [7, 2] },
    ],
    peaks: true,
    least: [0, 0.6],
    levels: ({ config }) => (config ? [{ label: "direct caging", value: config.judging.force_bound }] : []),
  },
  {
    id: "rates",
    title: "Angular velocity",
    unit: "rad/s",
    decimals: 3,
    curves: [
      { quantity: "spin", label: "Target", token: "target" },
      { quantity: "baseRate", label: "Base", token: "base", dash: [7, 2] },
    ],
    least: [-0.1, 0.6],
    levels: ({ snapshot }) => (snapshot ? [{ label: "threshold", value: snapshot.spin_threshold }] : []),
  },
  {
    id: "attitude",
    title: "Base attitude",
    unit: "rad",
    decimals: 4,
    curves: [{ quantity: "baseAngle", label: "Base", token: "base" }],
    least: [-0.02, 0.02],
    levels: () => [],
  },
  {
    id: "manipulability",
    title: "Manipulability",
    unit: "m2",
    decimals: 4,
    curves: [
      { quantity: "leftManipulability", label: "Left", token: "left" },
      { quantity: "rightManipulability", label: "Right", token: "right", dash: [7, 2] },
    ],
    least: [0, 0.05],
    levels: ({ config }) => (config ? [{ label: "warning", value: config.control.rates.manipulability_warning }] : []),
  },
];

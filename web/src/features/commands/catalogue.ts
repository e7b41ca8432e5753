/** The commands on the page: their words, and what each will do. */
import type { Command } from "../../api/types";

export interface CommandWords {
  readonly command: Command;
  readonly label: string;
  readonly does: string;
  /** What it does to a robot, beside moving it. */
  readonly withRobot?: string;
}

export const CAPTURE: CommandWords = {
  command: "capture",
  label: "Capture",
  does: "The whole sequence: detumble by soft touches, cage with both hands, lock the arms.",
};

export const SEQUENCE: readonly CommandWords[] = [
  { command: "detumble", label: "Detumble", does: "Touches the target until its spin is below the threshold, then holds." },
  { command: "cage", label: "Cage", does: "Both hands enclose the target now, at any spin." },
  { command: "direct_cage", label: "Direct caging", does: "Encloses the target without detumbling: the comparison of the paper." },
  { command: "hold", label: "Hold", does: "Holds all joints where they are." },
  { command: "release", label: "Release", does: "Both hands open and draw back." },
];

export const RESET: CommandWords = {
  command: "reset",
  label: "Reset",
  does: "Ends this run and starts a new one with the chosen configuration.",
  withRobot: "A new mission takes over the robot in its current pose.",
};

export const PAUSE: CommandWords = { command: "pause", label: "Pause", does: "Pauses mission time." };
export const RUN: CommandWords = { command: "run", label: "Run", does: "Runs mission time at the chosen speed." };
export const STEP: CommandWords = { command: "step", label: "Step", does: "Advances by this many control ticks, then waits." };

export const BACK: CommandWords = {
  command: "fork",
  label: "Back",
  does: "Takes a paused mission back by this many ticks and continues from there as a new run; the old run stays in the library.",
};

const LABELS = new Map(
  [CAPTURE, ...SEQUENCE, RESET, PAUSE, RUN, STEP, BACK].map(({ command, label }): [string, string] => [command, label]),
);

export const labelOf = (order: string): string => LABELS.get(order) ?? order;

export interface Speed {
  readonly value: string;
  readonly label: string;
}

/** 0 is as fast as the machine goes. */
const SPEEDS: readonly Speed[] = [
  ...["0.1", "0.25", "0.5", "1", "2", "5", "10", "25"].map((value) => ({ value, label: `${value} ×` })),
  { value: "0", label: "Fastest" },
];

/** The speeds to choose from; one that a script has set is among them. */
export function speedsWith(speed: number): Speed[] {
  const value = String(speed);
  const known = SPEEDS.some((choice) => choice.value === value);
  return known ? [...SPEEDS] : [{ value, label: `${value} ×` }, ...SPEEDS];
}

/** How a capture ended, in words. */
import type { Outcome } from "../../api/types";

type OutcomeClass = Outcome["outcome"];

export interface Verdict {
  readonly tone: "good" | "fair" | "bad";
  readonly headline: string;
  readonly meaning: string;
}

const CAGED: Readonly<Partial<Record<OutcomeClass, Verdict>>> = {
  caged_force_reduced: {
    tone: "good",
    headline: "Caged, force reduced",
    meaning: "The target cannot escape the hands, and every touch was softer than direct caging.",
  },
  caged_force_not_reduced: {
    tone: "fair",
    headline: "Caged, force not reduced",
    meaning: "The target cannot escape the hands, but a touch was as hard as direct caging or harder.",
  },
  caged_unplanned_contact: {
    tone: "fair",
    headline: "Caged after unplanned contact",
    meaning: "The target cannot escape the hands, but they touched it when no touch was planned.",
  },
};

const FAILED: Readonly<Partial<Record<OutcomeClass, Verdict>>> = {
  ejection: { tone: "bad", headline: "Target ejected", meaning: "The target left the robot's reach." },
  base_collision: { tone: "bad", headline: "Collision with the base", meaning: "The target struck the robot's base." },
  unresolved: { tone: "bad", headline: "Not captured", meaning: "Time ran out before the target was caged." },
};

const NOT_HELD: Verdict = {
  tone: "bad",
  headline: "Closed, but not caged",
  meaning: "The hands closed around the target, but it can still escape.",
};

/** The verdict: that at locked arms, wherever a run is told of. The paper's, at first closure, is always named so. */
export function verdictOf(outcome: Outcome): Verdict {
  return (outcome.caged ? CAGED : FAILED)[outcome.outcome] ?? NOT_HELD;
}

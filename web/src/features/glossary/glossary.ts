/** What the words of a capture mean, for whoever meets them on a page: the definitions of docs/method.md in a sentence. */

const TERMS: Readonly<Record<string, string>> = {
  caged_force_reduced: "Captured, and no hand was ever pressed as hard as in direct caging: its resultant force stayed below judging.force_bound, 1.13 N unless edited.",
  caged_force_not_reduced: "Captured, but a hand was pressed as hard as in direct caging, or harder: at least judging.force_bound, 1.13 N unless edited.",
  caged_unplanned_contact: "Captured, but something touched the target that was not meant to: a tip while its hand was following a plan, or a link, palm or finger.",
  ejection: "The target got away: its centre is farther from the base's than judging.ejection_distance, 0.6 m unless edited.",
  base_collision: "The target and the robot's base ran into each other.",
  unresolved: "No closure within the time limit; or the arms locked, and the target can still get out.",
  outcome: "The class of the capture, by the instant that judging.rule names.",
  at_first_closure: "The class at the first instant that the four tips enclose a slow target, as the paper's tables have it. Nothing later counts.",
  at_locked_arms: "The class once the arms have locked and 2 s have passed: the target must be caged for good.",
  caged: "Whether no motion of the target leads it out of the locked hands.",
  cage_margin: "By how much the hands' surfaces would have to give way to let the target out, along its easiest way. Larger is safer.",
  peak_tip_force: "The largest resultant force on a hand over the whole capture, to the verdict.",
  peak_tip_force_to_closure: "The largest resultant force on a hand until the tips first enclosed the target, as the paper measures it. What comes after is often harder.",
  closed_at: "When the four tips first enclosed the target while it was slow.",
  locked_at: "When the joints stopped and the arms became one body with the base.",
  touches: "How often a hand touched the target; contacts of one arm closer than judging.touch_gap count once.",
  direct_caging: "Both hands enclose the target without detumbling it first: what the paper compares its method with.",
  unplanned: "A touch that no plan meant: the hand was still on its way, or something other than a tip touched.",
  final_target_spin: "The target's angular velocity at the verdict.",
  min_manipulability: "The least manipulability of both arms: near zero, an arm is stretched or folded and cannot move its hand in some direction.",
  momentum_error: "How far the total momentum of robot and target moved from zero. In the simulation nothing pushes from outside, so this is its error.",
  target_spin: "The target's angular velocity, counter-clockwise positive. The mark is the threshold below which the method may cage.",
  target_drift: "Speed of the target's centre. A drift that stays carries the target out of the hands' reach.",
  contact: "Whether each hand touches the target now, with the resultant force on it; below, the largest so far.",
  cage: "Open, closed (the four tips enclose the target at its present angle), or caged: no motion leads it out of the locked hands.",
  next_phase: "Whether the next phase may begin, with what speaks for or against it; blocked where nothing can come next.",
  mission_time: "Counted by control ticks from the beginning of this run; it stands while the clock is paused.",
  manipulability: "The volume of what an arm can make its hand's velocity; near zero it is at a singularity.",
  admittance: "The hand gives way like a mass on a spring and damper, M ẍ + D ẋ + K x = F, so that a touch is soft.",
  free_flying: "The base is not held: whatever the arms do turns and shifts it, as total momentum stays zero.",
  detumbling: "Taking the target's spin by soft touches, before both hands enclose it.",
  "cohen's κ": "Agreement beyond chance: 1 is full agreement, 0 is no better than guessing by how common each class is.",
};

/** Every term as it is read, with its meaning. */
export const glossaryTerms = (): readonly { readonly term: string; readonly meaning: string }[] => Object.entries(TERMS).map(([term, meaning]) => ({ term: term.replaceAll("_", " "), meaning }));

/** What a term means; null if there is nothing to explain. Names of classes and of columns are terms. */
export const meaningOf = (term: string): string | null => TERMS[term.toLowerCase()] ?? null;

/** What the words on the pages mean, in one place: each page's tips come from here. */
export const GLOSSARY = {
  peak_to_closure:
    "The largest force that a hand felt from the target until its tips first enclosed the slow target. The paper's tables judge by it.",
  peak_to_locked: "The largest force that a hand felt from the target until the arms were locked; it includes the blow of the closing.",
  cage_margin:
    "How far the tips would have to give way, in millimetres, before some motion could lead the target out of the locked hands. None: there is a way out.",
  closed_at: "When the tips first enclosed the target after its spin was under the threshold, in mission time.",
  force_reduced:
    "Reduced against direct caging, which encloses the target without detumbling it first: every touch was softer than the force that judging.force_bound names.",
  unplanned: "A hand touched the target while a plan was still being followed: no touch was meant to happen then.",
  planned: "The hand stood where the target's face was to come to it, as planned.",
  direct_caging: "Both hands enclose the target without detumbling it first: what the paper compares its method with.",
} as const;

export type GlossaryTerm = keyof typeof GLOSSARY;

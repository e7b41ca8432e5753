/** Outcomes and other classes by the colours of Okabe and Ito, which colour-blind people tell apart, a letter and words. */

export interface ClassStyle {
  readonly colour: string;
  readonly letter: string;
  readonly words: string;
}

const STYLES: Readonly<Record<string, ClassStyle>> = {
  caged_force_reduced: { colour: "#009e73", letter: "R", words: "caged, force reduced" },
  caged_force_not_reduced: { colour: "#56b4e9", letter: "N", words: "caged, force not reduced" },
  caged_unplanned_contact: { colour: "#f0e442", letter: "U", words: "caged, unplanned contact" },
  base_collision: { colour: "#d55e00", letter: "B", words: "base collision" },
  ejection: { colour: "#cc79a7", letter: "E", words: "ejection" },
  unresolved: { colour: "#a8adb5", letter: "–", words: "unresolved" },
  true: { colour: "#009e73", letter: "✓", words: "yes" },
  false: { colour: "#d55e00", letter: "×", words: "no" },
  left: { colour: "#56b4e9", letter: "L", words: "left" },
  right: { colour: "#e69f00", letter: "R", words: "right" },
};

/** The classes of an outcome, best first. */
export const CLASSES = Object.keys(STYLES).slice(0, 6);

export const FAILED_STYLE: ClassStyle = { colour: "#ffffff", letter: "!", words: "failed to run" };

export const classStyle = (name: string): ClassStyle =>
  STYLES[name] ?? { colour: "#a8adb5", letter: name.slice(0, 1).toUpperCase(), words: name.replaceAll("_", " ") };

/** The order in which classes stand in a legend. */
export const inOrder = (names: Iterable<string>): string[] => {
  const known = Object.keys(STYLES);
  return [...names].sort((a, b) => known.indexOf(a) - known.indexOf(b));
};

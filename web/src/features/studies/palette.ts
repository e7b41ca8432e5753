/** Colours of maps that colour-blind people tell apart (Okabe and Ito; viridis), each class with a letter beside. */

export interface ClassLook {
  readonly colour: string;
  readonly letter: string;
  readonly words: string;
}

const LOOKS: Readonly<Record<string, ClassLook>> = {
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

export const FAILED_LOOK: ClassLook = { colour: "#ffffff", letter: "!", words: "could not be flown" };

export const lookOf = (name: string): ClassLook =>
  LOOKS[name] ?? { colour: "#a8adb5", letter: name.slice(0, 1).toUpperCase(), words: name.replaceAll("_", " ") };

/** The order in which classes stand in a legend. */
export const inOrder = (names: Iterable<string>): string[] => {
  const known = Object.keys(LOOKS);
  return [...names].sort((a, b) => known.indexOf(a) - known.indexOf(b));
};

/** Samples of viridis (van der Walt, Smith, Firing 2015), from dark to bright. */
const VIRIDIS = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37],
] as const;

const at = (place: number): readonly [number, number, number] => VIRIDIS[Math.min(place, VIRIDIS.length - 1)] ?? VIRIDIS[0];

/** The colour of a fraction, 0 to 1, of a range. */
export function viridis(fraction: number): string {
  const along = Math.min(Math.max(fraction, 0), 1) * (VIRIDIS.length - 1);
  const [low, high, rest] = [at(Math.floor(along)), at(Math.floor(along) + 1), along % 1];
  const [red, green, blue] = low.map((value, channel) => Math.round(value + rest * ((high[channel] ?? value) - value)));
  return `rgb(${red}, ${green}, ${blue})`;
}

/** Black or white, whichever reads better on viridis at that fraction. */
export const inkOn = (fraction: number): string => (fraction > 0.6 ? "#10151c" : "#ffffff");

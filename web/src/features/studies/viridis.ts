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

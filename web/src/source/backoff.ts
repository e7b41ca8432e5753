/** Waiting times between attempts to reach the service again, in milliseconds: soon at first, never rarely. */
const FIRST = 250;
const LONGEST = 4000;

/** Attempt 1, 2, ...; `random` in [0, 1) spreads the browsers of a lab that all lost the same service. */
export function waitBefore(attempt: number, random: () => number = Math.random): number {
  const wait = Math.min(LONGEST, FIRST * 2 ** (attempt - 1));
  return Math.round(wait * (0.8 + 0.4 * random()));
}

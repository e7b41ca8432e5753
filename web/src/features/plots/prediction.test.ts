import { describe, expect, it } from "vitest";
import type { PhaseSpan } from "../../source/series";
import { bandsOf, extentOf, shiftOf } from "./prediction";

const BAND = { times: [10, 11, 12], low: [0, -1, -2], median: [1, 1, 1], high: [2, 3, 4] };
const IDLE: PhaseSpan = { phase: "idle", start: 0, end: 15 };

describe("a prediction", () => {
  it("lies ahead of now until its request is given, and then stays where the sequence began", () => {
    const prediction = { from: 10, requested: true };
    expect(shiftOf(prediction, [IDLE], 10)).toBe(0);
    expect(shiftOf(prediction, [IDLE], 13.5)).toBe(3.5);
    const flown: PhaseSpan[] = [IDLE, { phase: "detumbling", start: 15, end: 18 }, { phase: "caging", start: 18, end: 20 }];
    expect(shiftOf(prediction, flown, 20)).toBe(5);
  });

  it("of what is under way stands where it was made", () => {
    expect(shiftOf({ from: 16, requested: false }, [IDLE, { phase: "detumbling", start: 15, end: 18 }, { phase: "caging", start: 18, end: 30 }], 30)).toBe(0);
  });

  it("of a capture after a release begins with the next sequence, not with an earlier one", () => {
    const flown: PhaseSpan[] = [IDLE, { phase: "detumbling", start: 15, end: 18 }, { phase: "released", start: 18, end: 30 }, { phase: "detumbling", start: 30, end: 31 }];
    expect(shiftOf({ from: 25, requested: true }, flown, 31)).toBe(5);
  });

  it("reaches as far as it does within the stretch that is shown", () => {
    expect(extentOf(BAND, 5, 0, 16.5)).toEqual([-1, 3]);
    expect(extentOf(BAND, 5, 0, 14)).toBeNull();
  });

  it("has bands of what is plotted alone", () => {
    expect([...bandsOf([{ ...BAND, quantity: "left.force" }, { ...BAND, quantity: "no.such" }]).keys()]).toEqual(["leftForce"]);
  });
});

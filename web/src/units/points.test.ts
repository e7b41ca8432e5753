import { describe, expect, it } from "vitest";
import cases from "./points.cases.json";
import { isPoints, pointsText, readPoints } from "./points";

describe("points that a person types", () => {
  // tests/unit/test_typed.py reads the same cases on the command line.
  it.each(cases)("$text", ({ text, points, error }) => {
    expect(readPoints(text)).toEqual(points === undefined ? { error } : { points });
  });

  it("are read again as they are written", () => {
    const points = [[0, 0], [0.2, -1e-4], [0, 0.1]] as const;
    expect(readPoints(pointsText(points))).toEqual({ points });
    expect(pointsText([[1, 2]], 1000)).toBe("1000, 2000");
  });

  it("are told from other lists", () => {
    expect(isPoints([[0, 1]])).toBe(true);
    expect([isPoints([0, 1]), isPoints([[0, 1, 2]]), isPoints("0, 1"), isPoints([["a", 1]])]).toEqual([false, false, false, false]);
  });
});

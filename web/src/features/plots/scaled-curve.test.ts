import { expect, it } from "vitest";
import { scaledCurve } from "./scaled-curve";

it("a curve is numbers alone, and null where nothing was recorded", () => {
  expect(scaledCurve(new Float64Array([1, -2]), 3)).toEqual(new Float64Array([3, -6]));
  expect(scaledCurve(new Float64Array([1, Number.NaN, Infinity]), 2)).toEqual([2, null, null]);
});

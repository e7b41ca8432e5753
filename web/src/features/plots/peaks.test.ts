import { describe, expect, it } from "vitest";
import type { Touch } from "../../api/types";
import { Series } from "../../source/series";
import { QUANTITY_NAMES, type QuantityName, type Sample } from "../../source/quantities";
import { instantOfPeak } from "./peaks";

function forces(values: readonly number[]): Series {
  const series = new Series();
  values.forEach((leftForce, tick) => {
    const known: Partial<Record<QuantityName, number>> = { tick, time: tick / 10, leftForce };
    series.append(Object.fromEntries(QUANTITY_NAMES.map((name) => [name, known[name] ?? 0])) as Sample);
  });
  return series;
}

const touch = (start: number, end: number | null): Touch => ({ arm: "left", start, end, peak: 0.5, planned: true });

describe("the instant of a touch's peak", () => {
  const series = forces([0, 0.1, 0.4, 0.2, 0, 0.3, 0.1]);

  it("is that of the largest force within the touch, and of no other one", () => {
    expect(instantOfPeak(series, touch(0.1, 0.35))).toBeCloseTo(0.2, 9);
    expect(instantOfPeak(series, touch(0.5, 0.6))).toBeCloseTo(0.5, 9);
  });

  it("is looked for until now while the hand still touches", () => {
    expect(instantOfPeak(series, touch(0.45, null))).toBeCloseTo(0.5, 9);
  });

  it("is the beginning of a touch that no sample lies in", () => {
    expect(instantOfPeak(series, touch(0.7, 0.71))).toBe(0.7);
  });
});

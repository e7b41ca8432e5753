import { describe, expect, it } from "vitest";
import { classPairs, commonRange, measurePairs } from "./comparison";

const outcome = (name: string, share: number) => ({ outcome: name, cells: 1, share, low: null, high: null });

describe("two studies beside one another", () => {
  it("have the classes of both, best first", () => {
    const pairs = classPairs({ outcomes: [outcome("ejection", 1)] }, { outcomes: [outcome("base_collision", 0.25), outcome("caged_force_reduced", 0.75)] });
    expect(pairs).toEqual([
      { name: "caged_force_reduced", one: 0, other: 0.75 },
      { name: "base_collision", one: 0, other: 0.25 },
      { name: "ejection", one: 1, other: 0 },
    ]);
  });

  it("have the measures that both know", () => {
    const columns = [{ name: "peak_tip_force", kind: "float", unit: "N", description: "" }, { name: "cage_margin", kind: "float", unit: "m", description: "" }];
    const rows = (values: readonly (number | null)[]) => new Map(values.map((peak, cell) => [cell, { peak_tip_force: peak, cage_margin: null }]));
    expect(measurePairs(columns, rows([1, 2, 3]), rows([4, null]))).toEqual([{ name: "peak_tip_force", unit: "N", one: { median: 2, high: 2.9 }, other: { median: 4, high: 4 } }]);
  });

  it("have one scale of colours", () => {
    expect(commonRange([[1, 2], null, [0, 1.5]])).toEqual([0, 2]);
    expect(commonRange([null])).toBeNull();
  });
});

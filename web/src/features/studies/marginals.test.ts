import { describe, expect, it } from "vitest";
import type { StudyRow } from "../../api/types";
import type { Axis } from "./layout";
import { groupsOf, MOST_GROUPS, quantile, spreadOf } from "./marginals";

const axis = (values: (number | string)[] | null): Axis => ({ path: "a", unit: "1", description: "", count: values?.length ?? null, values, drawn_from: null });

const rows = (count: number, of: (place: number) => StudyRow): StudyRow[] => Array.from({ length: count }, (_, place) => of(place));

describe("a parameter alone", () => {
  it("has a group for each of its values, in their order", () => {
    const groups = groupsOf(axis([2, 1]), rows(6, (place) => ({ a: 1 + (place % 2), peak: place })));
    expect(groups.map(({ words, rows: of }) => [words, of.map((row) => row["peak"])])).toEqual([["2", [1, 3, 5]], ["1", [0, 2, 4]]]);
  });

  it("is cut into stretches of as many cells each where it is drawn, or has many values", () => {
    const drawn = groupsOf(axis(null), rows(96, (place) => ({ a: (37 * place) % 96 })));
    expect(drawn).toHaveLength(MOST_GROUPS);
    expect(drawn.map(({ rows: of }) => of.length)).toEqual(Array.from({ length: MOST_GROUPS }, () => 8));
    expect(drawn[0]?.rows.map((row) => row["a"])).toEqual([0, 1, 2, 3, 4, 5, 6, 7]);
    expect(groupsOf(axis(Array.from({ length: 40 }, (_, value) => value)), rows(40, (a) => ({ a })))).toHaveLength(10);
    expect(groupsOf(axis(null), [])).toHaveLength(1);
  });
});

describe("a measure in a group", () => {
  it("is five quantiles of numbers", () => {
    expect([quantile([1, 2, 3, 4], 0.5), quantile([1, 2, 3, 4], 0), quantile([7], 0.95)]).toEqual([2.5, 1, 7]);
    const spread = spreadOf(rows(101, (place) => ({ peak: 100 - place })), "peak");
    expect(spread).toEqual({ kind: "numbers", low: 5, quarter: 25, median: 50, threeQuarters: 75, high: 95, count: 101 });
  });

  it("is shares of classes, and nothing where no cell has it", () => {
    const spread = spreadOf([{ outcome: "ejection" }, { outcome: "ejection" }, { outcome: "unresolved" }, { outcome: null }], "outcome");
    expect(spread.kind === "classes" ? [...spread.shares].map(([name, share]) => [name, share.toFixed(3)]) : []).toEqual([["ejection", "0.667"], ["unresolved", "0.333"]]);
    expect(spreadOf([{ caged: true }, { caged: false }], "caged").kind).toBe("classes");
    expect(spreadOf([{ peak: null }], "peak")).toEqual({ kind: "none" });
  });
});

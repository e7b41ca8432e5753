import { describe, expect, it } from "vitest";
import { DraftError, EMPTY_DRAFT, nested, requestOf } from "./definition";

const gridOf = (values: string): unknown => {
  const { study } = requestOf({ ...EMPTY_DRAFT, grid: [{ path: "target.mass", values }] }, false);
  return (study as unknown as { grid: Record<string, unknown> }).grid["target.mass"];
};

describe("the values of an axis", () => {
  it("are listed or spread over a range", () => {
    expect(gridOf("1, 2.5,3")).toEqual([1, 2.5, 3]);
    expect(gridOf("face, radial")).toEqual(["face", "radial"]);
    expect(gridOf("0 .. 6 by 1.5")).toEqual({ from: 0, to: 6, step: 1.5 });
    expect(gridOf("-1..1 in 5")).toEqual({ from: -1, to: 1, count: 5 });
  });

  it("say what cannot be read", () => {
    expect(() => gridOf("0 .. 6")).toThrow(DraftError);
    expect(() => gridOf("0 .. six by 1")).toThrow(/"six" is no number/);
  });
});

describe("a request", () => {
  it("has samples only where something is drawn", () => {
    expect(requestOf(EMPTY_DRAFT, false).study).not.toHaveProperty("samples");
    const drawn = requestOf({ ...EMPTY_DRAFT, draws: [{ path: "target.mass", distribution: "2.35 ± 0.1" }, { path: "target.initial_spin", distribution: "0.5 .. 1.5" }] }, true);
    expect(drawn.study).toHaveProperty("samples.over", { "target.mass": { mean: 2.35, deviation: 0.1 }, "target.initial_spin": { from: 0.5, to: 1.5 } });
    expect(drawn.confirm).toBe(true);
  });
});

it("nests settings by their paths", () => {
  expect(nested({ "a.b.c": 1, "a.b.d": 2, e: 3 })).toEqual({ a: { b: { c: 1, d: 2 } }, e: 3 });
});

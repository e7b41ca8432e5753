import { describe, expect, it } from "vitest";
import { axisOf, distributionOf, EMPTY_DRAFT, nested, readDraft, readKeptDraft, type StudyDraft } from "./definition";

describe("the values of an axis", () => {
  it.each<[string, unknown]>([
    ["1, 2.5,3", [1, 2.5, 3]],
    ["face, radial", ["face", "radial"]],
    ["0 .. 6 by 1.5", { from: 0, to: 6, step: 1.5 }],
    ["0..15 by 1.5", { from: 0, to: 15, step: 1.5 }],
    ["0…6 BY .5", { from: 0, to: 6, step: 0.5 }],
    ["-1..1 in 5", { from: -1, to: 1, count: 5 }],
    ["−1 .. −0.5 in 2", { from: -1, to: -0.5, count: 2 }],
    ["0.01 .. 1 in 5 log", { from: 0.01, to: 1, count: 5, spacing: "logarithmic" }],
    ["０．１ .. ０．３ by ０．１", { from: 0.1, to: 0.3, step: 0.1 }],
  ])("%s", (text, axis) => {
    expect(axisOf(text)).toEqual({ is: axis });
  });

  it.each([
    ["0 .. 6", 'say how the range is divided: "by 0.5" or "in 5"'],
    ["0 .. six by 1", '"six" is not a number; write it as 5, 0.5 or 5e-1'],
    ["0,5", 'write 0.5: the decimal sign is a point; for two values write "0, 5"'],
    ["0,05, 0,1", "write 0.05: the decimal sign is a point"],
    ["0 .. 1,5 by 0.5", "write 1.5: the decimal sign is a point"],
    ["0 .. 15 by 1,5", "write 1.5: the decimal sign is a point"],
    ["0 .. 15 by 1.5, 20", '"1.5, 20" is not a number; write it as 5, 0.5 or 5e-1'],
    ["0 .. 15 by", '"15 by" is not a number; write it as 5, 0.5 or 5e-1'],
    ["0 .. 15 by 0", "the step must be greater than 0"],
    ["0 .. 15 in 2.5", "takes whole numbers"],
    ["0 .. 15 in 0", "a range has at least one value"],
    ["6 .. 0 by 1", "the range ends below its beginning; write 0 .. 6"],
    ["0.1 .. 1 by 0.1 log", 'a logarithmic range is divided by a count: "0.01 .. 1 in 5 log"'],
    ["", "values are missing"],
  ])("%s is refused", (text, error) => {
    expect(axisOf(text)).toEqual({ error });
  });
});

describe("a distribution", () => {
  it("is uniform or normal", () => {
    expect(distributionOf("2.35 ± 0.1")).toEqual({ is: { mean: 2.35, deviation: 0.1 } });
    expect(distributionOf("2.35+/-0.1")).toEqual({ is: { mean: 2.35, deviation: 0.1 } });
    expect(distributionOf("0.5..1.5")).toEqual({ is: { from: 0.5, to: 1.5 } });
    expect(distributionOf("0.5 .. 1.5 log")).toEqual({ is: { from: 0.5, to: 1.5, spacing: "logarithmic" } });
  });

  it.each(["2,35 ± 0.1", "0.5", "0.5 .. 1.5 by 0.1", "1 ± 2 ± 3", ""])("%s is refused", (text) => {
    expect(distributionOf(text)).toHaveProperty("error");
  });
});

describe("a draft that was kept", () => {
  it("is read if it is a whole one", () => {
    const draft = { ...EMPTY_DRAFT, name: "mine" };
    expect(readKeptDraft(JSON.parse(JSON.stringify(draft)))).toEqual(draft);
    for (const other of [null, "x", { name: "mine" }, { ...draft, grid: [{ path: 3 }] }, { ...draft, direct: "no" }]) expect(readKeptDraft(other)).toEqual(EMPTY_DRAFT);
  });
});

describe("a draft", () => {
  const draft = (part: Partial<StudyDraft>) => readDraft({ ...EMPTY_DRAFT, ...part });
  const damping = { path: "published.impedance.damping", values: "1, 2" };

  it("has samples only where something is drawn", () => {
    expect(readDraft(EMPTY_DRAFT).request?.study).not.toHaveProperty("samples");
    const { request } = readDraft({ ...EMPTY_DRAFT, draws: [{ path: "target.mass", distribution: "2.35 ± 0.1" }, { path: "target.initial_spin", distribution: "0.5 .. 1.5" }] }, true);
    expect(request?.study).toHaveProperty("samples.over", { "target.mass": { mean: 2.35, deviation: 0.1 }, "target.initial_spin": { from: 0.5, to: 1.5 } });
    expect(request?.confirm).toBe(true);
  });

  it("may have empty lines", () => {
    const { request, faults } = draft({ grid: [damping, { path: " ", values: "" }], draws: [{ path: "", distribution: "" }], count: "" });
    expect(faults.size).toBe(0);
    expect(request?.study).toHaveProperty("grid", { "published.impedance.damping": [1, 2] });
    expect(request?.study).not.toHaveProperty("samples");
  });

  it("names the line that is incomplete", () => {
    const { request, faults } = draft({ grid: [damping, { path: "target.mass", values: " " }, { path: "", values: "1, 2" }] });
    expect(request).toBeNull();
    expect([...faults]).toEqual([["grid 1", "values are missing"], ["grid 2", "the parameter is missing"]]);
  });

  it("names both lines of one parameter, also where one is drawn", () => {
    const twice = draft({ grid: [damping, { path: " published.impedance.damping ", values: "3" }], draws: [{ path: "published.impedance.damping", distribution: "0 .. 1" }] });
    const words = "published.impedance.damping stands in line 1 of the grid already; write all of its values in one line";
    expect([...twice.faults]).toEqual([["grid 1", words], ["draws 0", words]]);
  });

  it("varies something, with whole seed and count", () => {
    expect(draft({ grid: [] }).faults.get("lines")).toMatch(/varies nothing/);
    expect(draft({ seed: "1,000" }).faults.get("seed")).toMatch(/write 1000 or 1\.000/);
    expect(draft({ seed: "-1" }).faults.get("seed")).toBe("a seed is not negative");
    expect(draft({ seed: "9223372036854775807" }).faults.get("seed")).toMatch(/9007199254740991/);
    expect(draft({ draws: [{ path: "target.mass", distribution: "2 .. 3" }], count: "1.5" }).faults.get("count")).toBe("takes whole numbers");
  });
});

it("nests settings by their paths", () => {
  expect(nested({ "a.b.c": 1, "a.b.d": 2, e: 3 })).toEqual({ a: { b: { c: 1, d: 2 } }, e: 3 });
});

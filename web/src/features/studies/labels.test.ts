import { describe, expect, it } from "vitest";
import { about, estimateWords, span, valuesWords } from "./labels";

const estimate = { cells: 484, axes: [], seconds: 71.4, measuring: false, basis: "6 of its cells", age: 1, studies_before: 0, confirmation_needed: false };

describe("an estimate", () => {
  it("tells cells and time", () => {
    expect(estimateWords(estimate)).toBe("484 cells, about 1 min 11 s.");
    expect(estimateWords({ ...estimate, cells: 1, seconds: 0.2 })).toBe("1 cell, about 1 s.");
    expect(estimateWords({ ...estimate, cells: 12000, seconds: 4000 })).toBe("12\u202f000 cells, about 1 h 6 min.");
  });

  it("says what is not known yet, and what comes first", () => {
    expect(estimateWords({ ...estimate, seconds: null, measuring: true })).toBe("484 cells; measuring how long they take.");
    expect(estimateWords({ ...estimate, seconds: null, basis: "no worker" })).toBe("484 cells; how long they take is not known: no worker.");
    expect(estimateWords({ ...estimate, studies_before: 2 })).toBe("484 cells, about 1 min 11 s. It starts after 2 studies that run or wait.");
  });
});

describe("durations", () => {
  it.each([[0.4, "1 s"], [59.2, "1 min 0 s"], [119.7, "2 min 0 s"], [3599.5, "1 h 0 min"], [7260, "2 h 1 min"]])("%s s is %s", (seconds, words) => {
    expect(span(seconds)).toBe(words);
  });

  it("are rounded where they are estimates", () => {
    expect(about(3.4)).toBe("about 3 s");
    expect(about(134)).toBe("about 2 min 10 s");
  });
});

it("an axis is told as it was understood", () => {
  const axis = { path: "published.impedance.damping", unit: "N s/m", description: "", drawn_from: null };
  expect(valuesWords({ ...axis, count: 5, values: [0, 1.5, 3, 4.5, 6] })).toBe("5 values: 0, 1.5, … 6 N·s/m");
  expect(valuesWords({ ...axis, unit: "1", count: 1, values: ["face"] })).toBe("1 value: face");
  expect(valuesWords({ ...axis, count: null, values: null })).toBe("");
});

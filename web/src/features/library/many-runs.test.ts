import { describe, expect, it } from "vitest";
import { Refusal } from "../../api/refusal";
import type { RunSummary } from "../../api/types";
import { csvCell } from "../../ui/export/csv";
import { forEachRun, resultWords } from "./bulk";
import { DEFAULT_OVERLAY, overlayHash, overlayOf } from "./overlay-address";
import { DEFAULT_QUERY } from "./query";
import { readSaved, withFilter } from "./saved-filters";
import { extentOf, rangeBetween, withRuns } from "./selection";
import { quantile, statisticsOf, verdictsOf, wilson } from "./statistics";
import { runsAsCsv } from "./table-file";

function run(id: string, peak: number | null, changes: readonly { path: string; value: unknown }[] = []): RunSummary {
  const outcome = peak === null ? null : { outcome: peak > 1 ? "ejection" : "caged_force_reduced", at_first_closure: "unresolved", caged: peak <= 1, peak_tip_force: peak, peak_tip_force_to_closure: peak, cage_margin: null, closed_at: null, contacts: [], duration: 3, final_target_spin: 0, min_manipulability: 0, momentum_error: 0 };
  return { id, outcome, tags: [], changes, name: "", ticks: 1, seed: 1, direct: false } as unknown as RunSummary;
}

const RUNS = [run("A", 0.25), run("B", 0.5), run("C", 2), run("D", null)];

describe("a selection of runs", () => {
  it("grows and shrinks by the page, and by all between two presses", () => {
    const [one] = RUNS;
    const some = withRuns(new Map(), rangeBetween(RUNS, "C", "A"), true);
    expect([...some.keys()]).toEqual(["A", "B", "C"]);
    expect(extentOf(some, RUNS)).toBe("some");
    expect(extentOf(withRuns(some, RUNS, true), RUNS)).toBe("all");
    expect(extentOf(withRuns(some, RUNS, false), RUNS)).toBe("none");
    expect(rangeBetween(RUNS, "of another page", "A")).toEqual([one]);
  });
});

describe("what many runs say", () => {
  it("is told by mean, spread and quantiles of those that have it", () => {
    const [peak] = statisticsOf(RUNS);
    expect(peak).toMatchObject({ count: 3, least: 0.25, median: 0.5, largest: 2 });
    expect(peak?.mean).toBeCloseTo(0.91667, 5);
    expect(peak?.deviation).toBeCloseTo(0.94648, 5);
    expect(quantile([1, 2, 3, 4], 0.25)).toBe(1.75);
    expect(statisticsOf(RUNS).map(({ measure }) => measure.term)).not.toContain("cage_margin");
  });

  it("counts verdicts among the runs that have one, with Wilson's interval", () => {
    expect(verdictsOf(RUNS).map(({ outcome, count, total }) => [outcome, count, total])).toEqual([["caged_force_reduced", 2, 3], ["ejection", 1, 3]]);
    const [low, high] = wilson(97, 100);
    expect([low, high].map((share) => share.toFixed(3))).toEqual(["0.915", "0.990"]);
    expect(wilson(0, 10)[0]).toBe(0);
  });
});

describe("many runs as a table", () => {
  it("has a column for each parameter that one of them changed", () => {
    const text = runsAsCsv([run("A", 0.25, [{ path: "published.impedance.damping", value: 3 }]), run("B", null)]);
    const [head = "", one = "", other = ""] = text.split("\r\n");
    expect(head.endsWith(",published.impedance.damping")).toBe(true);
    expect(one.endsWith(",3")).toBe(true);
    expect(other.endsWith(",")).toBe(true);
    expect(new Set([head, one, other].map((line) => line.split(",").length)).size).toBe(1);
  });

  it("quotes what a table or a spreadsheet would misread, and leaves numbers alone", () => {
    expect(csvCell('a "b", c')).toBe('"a ""b"", c"');
    expect(csvCell("=HYPERLINK(1)")).toBe("'=HYPERLINK(1)");
    expect(csvCell("-0.5")).toBe("-0.5");
    expect(csvCell(-0.5)).toBe("-0.5");
  });
});

describe("a request for each of many runs", () => {
  it("goes on where one is refused, and says which", async () => {
    const told: number[] = [];
    const result = await forEachRun(["A", "B", "C"], (id) => (id === "B" ? Promise.reject(new Refusal(409, "Refused", "B is the live mission", "", [])) : Promise.resolve()), (answered) => { told.push(answered); });
    expect(result).toEqual({ done: 2, refused: [{ id: "B", why: "B is the live mission" }] });
    expect(told).toEqual([1, 2, 3]);
    expect(resultWords(result, "deleted")).toBe("2 runs deleted; 1 was refused: B is the live mission");
    expect(resultWords({ done: 1, refused: [] }, "tagged")).toBe("1 run tagged.");
  });
});

describe("what a person keeps", () => {
  it("is a filter by name, in place of another of that name, without its page", () => {
    const saved = withFilter([], " stiff ", { ...DEFAULT_QUERY, text: "stiffness", page: 3 });
    expect(saved).toEqual([{ name: "stiff", address: "text=stiffness" }]);
    expect(withFilter(saved, "stiff", { ...DEFAULT_QUERY, starred: true })).toEqual([{ name: "stiff", address: "starred=true" }]);
  });

  it("is read whatever stands there", () => {
    expect(readSaved(null)).toEqual([]);
    expect(readSaved([{ name: "a", address: "kind=nonsense&starred=true&x=1" }, { name: 3 }, "b"])).toEqual([{ name: "a", address: "starred=true" }]);
  });
});

describe("the address of several runs", () => {
  it("is read as it is written", () => {
    const overlay = { runs: ["A", "B"], x: "target.twist.angle", y: "left.hand_force + 1", align: "closure" } as const;
    expect(overlayOf(overlayHash(overlay))).toEqual(overlay);
    expect(overlayHash({ runs: ["A"] })).toBe("#/runs/overlay?runs=A");
  });

  it("asks for no run twice, and for the usual where it says nothing", () => {
    expect(overlayOf("#/runs/overlay?runs=A,A,,B&align=never")).toEqual({ ...DEFAULT_OVERLAY, runs: ["A", "B"] });
  });
});

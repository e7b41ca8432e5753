import { describe, expect, it } from "vitest";
import type { Band, Decider, RehearsalCase, RehearsalResult } from "../../api/types";
import { casesOf, decidingOf, oddsWords, rangesOf } from "./words";

const band = (measure: string, unit: string, low: number, median: number, high: number): Band => ({ measure, unit, description: measure, futures: 10, low, median, high });

const decider = (name: string, withPeak: number | null, withCaged: number | null): Decider => ({ name, unit: "1", description: name, with_peak_force: withPeak, with_caged: withCaged });

const caseOf = (bands: Band[], futures = 10, deciding: Decider[] = []): RehearsalCase =>
  ({ futures: 10, caged: { outcome: "caged", futures, share: futures / 10, low: 0.7, high: 1 }, bands, deciding }) as unknown as RehearsalCase;

const resultOf = (before: RehearsalCase, after: RehearsalCase | null): RehearsalResult => ({ as_it_is: before, as_changed: after }) as unknown as RehearsalResult;

describe("what a rehearsal says", () => {
  it("states odds with their interval", () => {
    expect(oddsWords({ outcome: "caged", futures: 97, share: 0.97, low: 0.915, high: 0.99 }, 100)).toBe("97 of 100 caged, 92 to 99 %");
  });

  it("puts both cases of a measure on one scale", () => {
    const [force] = rangesOf(resultOf(caseOf([band("peak_tip_force", "N", 0.1, 0.2, 0.3)]), caseOf([band("peak_tip_force", "N", 0.2, 0.4, 0.6)])), "rad");
    const [before, after] = force?.ranges ?? [];
    expect(before?.words).toBe("0.2 (0.1 to 0.3)");
    expect(after?.median).toBeCloseTo(2 * (before?.median ?? 0));
    expect(after?.high).toBeLessThan(1);
  });

  it("reads angles as a person prefers them, and leaves out what no future has", () => {
    const measures = rangesOf(resultOf(caseOf([band("base_turn", "rad", Math.PI / 180, Math.PI / 90, Math.PI / 60)]), null), "deg");
    expect(measures.map(({ measure, unit }) => [measure, unit])).toEqual([["base_turn", "°"]]);
    expect(measures[0]?.ranges.map(({ words }) => words)).toEqual(["2 (1 to 3)"]);
  });

  it("does not press narrow bands far from zero into a corner", () => {
    const [time] = rangesOf(resultOf(caseOf([band("time_to_cage", "s", 9.9, 10, 10.1)]), null), "rad");
    expect(time?.ranges[0]?.high).toBeGreaterThan(0.5);
    expect(time?.ranges[0]?.low).toBeLessThan(0.5);
  });

  it("says what being caged hangs on where futures differ in it, else what the force hangs on", () => {
    const deciding = [decider("friction", 0.2, -0.6), decider("target_mass", -0.9, null)];
    expect(decidingOf(caseOf([], 6, deciding))).toMatchObject({ with: "caged", rows: [{ name: "friction", value: -0.6 }] });
    expect(decidingOf(caseOf([], 10, deciding))).toMatchObject({ with: "peak force", rows: [{ name: "target mass" }, { name: "friction" }] });
    expect(decidingOf(caseOf([]))).toBeNull();
  });

  it("has one case where nothing was changed", () => {
    expect(casesOf(resultOf(caseOf([]), null)).map(({ name }) => name)).toEqual(["as_it_is"]);
  });
});

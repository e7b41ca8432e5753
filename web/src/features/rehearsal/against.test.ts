import { describe, expect, it } from "vitest";
import type { Outcome, RehearsalResult } from "../../api/types";
import { QUANTITY_NAMES, type Sample } from "../../source/quantities";
import { Series } from "../../source/series";
import { againstOf, oddsAgainst } from "./against";

const band = (measure: string, unit: string, low: number, median: number, high: number) => ({ measure, unit, description: "", futures: 10, low, median, high });

const RESULT = {
  as_it_is: {
    futures: 10,
    odds: [{ outcome: "caged_force_reduced", futures: 9, share: 0.9, low: 0.6, high: 0.98 }],
    bands: [band("peak_tip_force", "N", 0.1, 0.15, 0.3), band("time_to_cage", "s", 3, 3.5, 4), band("base_turn", "rad", 0.1, 0.15, 0.2)],
  },
  as_changed: null,
} as unknown as RehearsalResult;

const OUTCOME = { outcome: "caged_force_reduced", peak_tip_force: 0.35, closed_at: 13.6, locked_at: 14 } as unknown as Outcome;

/** One row a second from 8 s on; the base turns by a hundredth of a radian in each, from 10 s on. */
function turning(): Series {
  const series = new Series();
  for (let time = 8; time <= 40; time += 1) {
    const zero = Object.fromEntries(QUANTITY_NAMES.map((name) => [name, 0])) as Record<keyof Sample, number>;
    series.append({ ...zero, tick: 1000 * time, time, baseAngle: -0.04 * Math.max(0, time - 10) });
  }
  return series;
}

describe("predicted against real", () => {
  it("says of each measure whether it came out as predicted", () => {
    const rows = againstOf(RESULT, "as_it_is", OUTCOME, turning(), 10, "rad");
    expect(rows.map(({ measure, predicted, real, within }) => [measure, predicted, real, within])).toEqual([
      ["peak_tip_force", "0.15 (0.1 to 0.3)", "0.35", false],
      ["time_to_cage", "3.5 (3 to 4)", "3.6", true],
      ["base_turn", "0.15 (0.1 to 0.2)", "0.16", true],
    ]);
  });

  it("has room on its track for what came out far from what was predicted", () => {
    const [force] = againstOf(RESULT, "as_it_is", { ...OUTCOME, peak_tip_force: 3 }, turning(), 10, "rad");
    expect(force?.places.real).toBeLessThanOrEqual(1);
    expect(force?.places.real).toBeGreaterThan(force?.places.high ?? 1);
  });

  it("takes no difference for one that nobody can read", () => {
    const [force] = againstOf(RESULT, "as_it_is", { ...OUTCOME, peak_tip_force: 0.3001 }, turning(), 10, "rad");
    expect(force).toMatchObject({ real: "0.3", within: true });
  });

  it("has nothing real of what did not happen", () => {
    const rows = againstOf(RESULT, "as_it_is", { ...OUTCOME, closed_at: null }, turning(), 10, "rad");
    expect(rows.find(({ measure }) => measure === "time_to_cage")).toMatchObject({ real: "—", within: null });
  });

  it("says with what odds the outcome was predicted", () => {
    expect(oddsAgainst(RESULT, "as_it_is", OUTCOME)).toBe("9 of 10 caged, force reduced, 60 to 98 %");
    expect(oddsAgainst(RESULT, "as_it_is", { ...OUTCOME, outcome: "ejection" })).toBe("none of 10 futures: ejection");
  });
});

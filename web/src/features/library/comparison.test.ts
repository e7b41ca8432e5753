import { describe, expect, it } from "vitest";
import type { Run } from "../../api/types";
import { Series } from "../../source/series";
import { QUANTITY_NAMES, type QuantityName, type Sample } from "../../source/quantities";
import { comparedAt, comparedSlice, comparedWith } from "../plots/compared";
import { choices, figures, named } from "./comparison";

const run = (damping: number, seed: number): Run =>
  ({ config: { published: { impedance: { mass: 0.1, damping } }, simulation: { seed } }, seed, duration: 12.5, outcome: null }) as unknown as Run;

/** Idle until `begin`, then detumbling; the spin is the time. */
function recorded(begin: number, period: number, end: number): Series {
  const series = new Series();
  for (let tick = 0; tick * period <= end; tick += 1) {
    const time = tick * period;
    const values: Partial<Record<QuantityName, number>> = { tick, time, phase: time < begin ? 0 : 1, spin: time };
    series.append(Object.fromEntries(QUANTITY_NAMES.map((name) => [name, values[name] ?? 0])) as Sample);
  }
  return series;
}

describe("two runs beside one another", () => {
  it("differ in what was chosen differently, and in nothing else", () => {
    expect(choices(run(1.5, 0), run(1.5, 0))).toEqual([]);
    expect(choices(run(1.5, 0), run(3, 7))).toEqual([
      { name: "published.impedance.damping", one: "1.5", other: "3" },
      { name: "simulation.seed", one: "0", other: "7" },
    ]);
  });

  it("show a list of points as one value", () => {
    const of = (last: number): Run => ({ config: { target: { vertices: [[0, 0], [0.2, 0], [0, last]] } } }) as unknown as Run;
    expect(choices(of(0.1), of(0.1))).toEqual([]);
    expect(choices(of(0.1), of(0.2))).toEqual([{ name: "target.vertices", one: "0, 0; 0.2, 0; 0, 0.1", other: "0, 0; 0.2, 0; 0, 0.2" }]);
  });

  it("are named as on the form, each with its unit", () => {
    const parameters = [{ path: "published.impedance.damping", title: "Virtual damping of the hand", unit: "N s/m" }];
    expect(named(choices(run(1.5, 0), run(3, 7)), parameters)).toEqual([
      { name: "Virtual damping of the hand, N·s/m", path: "published.impedance.damping", one: "1.5", other: "3" },
      { name: "simulation.seed", one: "0", other: "7" },
    ]);
  });

  it("say so where one has no outcome yet", () => {
    expect(figures(run(1, 0), run(1, 0)).find((line) => line.name === "Verdict")?.one).toBe("—");
  });
});

describe("the second recording on the clock of the first", () => {
  const first = recorded(2, 0.1, 10);
  const second = recorded(5, 0.1, 8);

  it("begins to move where the first one does, or keeps its own clock", () => {
    expect(comparedWith(first, second, "motion").shift).toBeCloseTo(-3, 6);
    expect(comparedWith(first, second, "clock").shift).toBe(0);
  });

  it("is read at the moment of the first one, and nowhere beyond its ends", () => {
    const compared = comparedWith(first, second, "motion");
    expect(comparedAt(compared, "spin", 2)).toBeCloseTo(5, 6);
    expect(comparedAt(compared, "spin", -3)).toBeCloseTo(0, 6);
    expect(comparedAt(compared, "spin", 5.2)).toBeNaN();
    expect(comparedAt(compared, "spin", -3.2)).toBeNaN();
  });

  it("is drawn over the stretch that is shown", () => {
    const [times, [spin]] = comparedSlice(comparedWith(first, second, "motion"), { from: 1, to: 2 }, ["spin"]);
    expect(times[0]).toBeLessThanOrEqual(1);
    expect(times.at(-1)).toBeGreaterThanOrEqual(2);
    expect(spin?.length).toBe(times.length);
  });
});

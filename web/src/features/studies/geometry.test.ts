import { describe, expect, it } from "vitest";
import { geometryOf, geometryWith, LABEL_SIZE, LEGEND_MARGIN, LEGEND_STEP, legendPlaces, TITLE_SIZE } from "./geometry";
import type { GridAxis, Spread, Value } from "./layout";
import { fitting, numberWords, textWidth, ticksOf } from "./ticks";

const axis = (path: string, values: readonly Value[], unit = "N s/m"): GridAxis => ({ path, unit, description: "", count: values.length, values: [...values], drawn_from: null });
const evenly = (from: number, to: number, count: number): number[] => Array.from({ length: count }, (_, place) => from + ((to - from) * place) / (count - 1));
const decades = (count: number): number[] => evenly(-3, 2, count).map((power) => Number((10 ** power).toPrecision(12)));

const SPREADS: Readonly<Record<string, Spread>> = {
  "2 x 2": { x: axis("published.impedance.damping", [0, 1.5]), y: axis("published.impedance.stiffness", [0, 10]), facet: null },
  "11 x 11, four masses": { x: axis("published.impedance.damping", evenly(0, 15, 11)), y: axis("published.impedance.stiffness", evenly(0, 100, 11), "N/m"), facet: axis("published.impedance.mass", [0.01, 0.05, 0.1, 0.5], "kg") },
  "50 x 40": { x: axis("published.impedance.damping", evenly(0, 15, 50)), y: axis("published.impedance.stiffness", evenly(0, 100, 40), "N/m"), facet: null },
  "120 x 80": { x: axis("target.initial_spin", evenly(-3, 3, 120), "rad/s"), y: axis("target.mass", evenly(2, 2.7, 80), "kg"), facet: null },
  "logarithmic": { x: axis("published.impedance.damping", decades(30)), y: axis("published.impedance.mass", decades(25), "kg"), facet: null },
  "whole numbers": { x: axis("simulation.solver_iterations", evenly(10, 49, 40), "1"), y: axis("simulation.seed", evenly(1, 24, 24), "1"), facet: null },
  "choices and long names": { x: axis("control.rates.singularity_handling", ["pseudo_inverse", "damped_least_squares"], "1"), y: axis("published.touch.idle_arm_distance_factor", evenly(0, 10, 21), "1"), facet: null },
  "one axis": { x: axis("published.impedance.damping", evenly(0, 15, 200)), y: null, facet: null },
  "close values": { x: axis("target.mass", evenly(2.3481, 2.3489, 9), "kg"), y: axis("target.mass2", evenly(1000.001, 1000.009, 9), "kg"), facet: null },
};
const FRAMES = [{ width: 820, height: 700 }, { width: 1300, height: 900 }, { width: 520, height: 420 }];

describe.each(Object.entries(SPREADS))("a map of %s", (_, spread) => {
  it.each(FRAMES)("is legible in $width x $height", (frame) => {
    const { x, y, cell, wide, left, panel, size } = geometryOf({ spread, compared: false, frame, legendLines: 1, head: 0 });
    const ends = x.ticks.map(({ place, text }) => [(place + 0.5) * wide - textWidth(text, LABEL_SIZE) / 2, (place + 0.5) * wide + textWidth(text, LABEL_SIZE) / 2] as const);
    ends.forEach(([from], number) => { if (number > 0) expect(from).toBeGreaterThan(ends[number - 1]?.[1] ?? 0); });
    const lines = y?.ticks.map(({ place }) => place * cell) ?? [];
    lines.forEach((at, number) => { if (number > 0) expect(at - (lines[number - 1] ?? 0)).toBeGreaterThan(LABEL_SIZE); });
    // The upright title stands left of the widest label, and no title is longer than its panel.
    for (const { text } of y?.ticks ?? []) expect(left - textWidth(text, LABEL_SIZE) - 6).toBeGreaterThanOrEqual(TITLE_SIZE + 6);
    expect(textWidth(x.title, TITLE_SIZE)).toBeLessThanOrEqual(panel.width - left);
    expect(textWidth(y?.title ?? "", TITLE_SIZE)).toBeLessThanOrEqual(panel.height);
    expect(x.ticks.length).toBeGreaterThanOrEqual(Math.min(2, spread.x.values.length));
    expect(new Set(x.ticks.map(({ text }) => text)).size).toBe(x.ticks.length);
    expect(size.width).toBeLessThanOrEqual(Math.max(frame.width, 420));
  });

  it.each(FRAMES)("shows its whole legend in $width x $height", (frame) => {
    const legend = ["caged, force reduced", "caged, force not reduced", "caged, unplanned contact", "base collision", "ejection", "unresolved", "differs from the paper"];
    const { size, panel, across } = geometryWith(legend, { spread, compared: false, frame, head: 0 });
    const cells = Math.ceil((spread.facet?.values.length ?? 1) / across) * panel.height;
    const lines = Math.max(...legendPlaces(legend, size.width - LEGEND_MARGIN).map(({ line }) => line + 1));
    expect(cells + lines * LEGEND_STEP).toBeLessThanOrEqual(size.height);
  });
});

describe("labels", () => {
  it("are round where there is a choice", () => {
    expect(ticksOf(evenly(1, 30, 30), 6, () => 24).map(({ text }) => text)).toEqual(["5", "10", "15", "20", "25", "30"]);
    expect(ticksOf(evenly(0, 15, 50), 13, () => 60).map(({ text }) => text)).toEqual(["0", "2", "4", "6", "8", "10", "12", "14"]);
    expect(ticksOf(evenly(0, 15, 50), 13, () => 60)[1]?.place).toBeCloseTo((2 / 15) * 49);
    expect(ticksOf(decades(41), 10, () => 30).map(({ text }) => text)).toEqual(["0.001", "0.01", "0.1", "1", "10", "100"]);
    expect(ticksOf(evenly(0, 15, 11), 40, () => 24)).toHaveLength(11);
  });

  it("have as few figures as tell them apart", () => {
    expect(numberWords([0.102040816, 0.204081633])).toEqual(["0.102", "0.204"]);
    expect(numberWords([1000.001, 1000.002])).toEqual(["1000.001", "1000.002"]);
  });

  it("are cut short only where nothing shorter fits", () => {
    expect(fitting(["impedance damping [N·s/m]", "damping [N·s/m]"], 100, 11)).toBe("damping [N·s/m]");
    expect(fitting(["damping"], 30, 11)).toBe("dam…");
  });
});

it("a legend goes on in the next line", () => {
  expect(legendPlaces(["caged", "ejection", "unresolved"], 180).map(({ line }) => line)).toEqual([0, 0, 1]);
});

import { describe, expect, it } from "vitest";
import type { StudyDetail } from "../../api/types";
import { cellsAt, panelsOf, pointsOf, rangeOf, shownAt, usualSpread } from "./layout";

const axis = (path: string, values: number[] | null) => ({ path, unit: "1", description: "", values, drawn_from: null });

const study = (total: number, ...axes: ReturnType<typeof axis>[]): StudyDetail =>
  ({ axes, progress: { done: 0, total, wall_time: 0 } }) as unknown as StudyDetail;

const published = study(484, axis("mass", [1, 2, 3, 4]), axis("damping", Array(11).fill(0).map((_, i) => i)), axis("stiffness", Array(11).fill(0).map((_, i) => i)));

describe("the places of cells", () => {
  it("follow the service's order: the last axis changes fastest", () => {
    expect(cellsAt(published, new Map([["mass", 1], ["damping", 2], ["stiffness", 3]]))).toEqual([121 + 22 + 3]);
  });

  it("hold all draws of a sample", () => {
    const sampled = study(12, axis("mass", [1, 2]), axis("friction", [1, 2]), axis("spin", null));
    expect(pointsOf(sampled)).toBe(3);
    expect(cellsAt(sampled, new Map([["mass", 1], ["friction", 0]]))).toEqual([6, 7, 8]);
  });

  it("cover a study once", () => {
    const spread = usualSpread(published);
    if (spread === null) throw new Error("it has a grid");
    expect([spread.x.path, spread.y?.path, spread.facet?.path]).toEqual(["damping", "stiffness", "mass"]);
    const cells = panelsOf(published, spread, new Map()).flatMap((panel) => panel.places.flatMap((place) => place.cells));
    expect(new Set(cells).size).toBe(484);
    expect(Math.max(...cells)).toBe(483);
  });

  it("are none without a grid", () => {
    expect(usualSpread(study(8, axis("spin", null)))).toBeNull();
  });
});

describe("what a place shows", () => {
  it("is the most frequent class with its share", () => {
    const rows = ["ejection", "ejection", "unresolved"].map((outcome) => ({ outcome, error: null }));
    expect(shownAt(rows, "outcome")).toEqual({ kind: "class", name: "ejection", share: 2 / 3 });
  });

  it("is the mean of numbers, without those that are missing", () => {
    expect(shownAt([{ peak: 1, error: null }, { peak: 3, error: null }, { peak: null, error: "odd" }], "peak")).toEqual({ kind: "number", value: 2 });
  });

  it("tells a failed cell from one that was not flown", () => {
    expect(shownAt([{ peak: null, error: "odd" }], "peak")).toEqual({ kind: "failed" });
    expect(shownAt([], "peak")).toEqual({ kind: "empty" });
    expect(shownAt([{ peak: null, error: null }], "peak")).toEqual({ kind: "none" });
  });

  it("has a range over all rows", () => {
    expect(rangeOf([{ peak: 2 }, { peak: null }, { peak: -1 }], "peak")).toEqual([-1, 2]);
    expect(rangeOf([{ peak: null }], "peak")).toBeNull();
  });
});

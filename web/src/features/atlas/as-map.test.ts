import { describe, expect, it } from "vitest";
import type { AtlasCell, AtlasDetail } from "../../api/types";
import { cellsAt } from "../studies/layout";
import { CAGED_SHARE, detailOf, mappedOf, numberOf, placeOf, placeOn, rowsOf, spanOf, surenessBy } from "./as-map";

const axis = (path: string, values: number[], present: number) => ({ path, unit: "1", description: path, values, present });

const ATLAS = { x: axis("a.x", [0, 1, 2], 1.5), y: axis("a.y", [10, 20], 30), measures: [{ measure: "peak_tip_force", unit: "N", description: "" }], progress: { done: 1, total: 6, wall_time: 1 } } as unknown as AtlasDetail;

const cell = (x: number, y: number, more: Partial<AtlasCell> = {}): AtlasCell => ({ x, y, futures: 3, caged: 2, outcome: "caged_force_reduced", odds: 2 / 3, outcomes: {}, measures: { peak_tip_force: 0.4 }, error: null, ...more });

const rowsFor = (...cells: AtlasCell[]) => rowsOf(ATLAS, new Map(cells.map((each) => [numberOf(ATLAS, each), each])));

describe("an atlas as a map", () => {
  it("numbers its cells as the map finds them", () => {
    for (const [x, y] of [[0, 0], [2, 1], [1, 0]] as const) {
      const number = numberOf(ATLAS, { x, y });
      expect(cellsAt(mappedOf(ATLAS), new Map([["a.x", x], ["a.y", y]]))).toEqual([number]);
      expect(placeOf(ATLAS, number)).toEqual({ x, y });
    }
  });

  it("marks the present point between cells, and not beyond them", () => {
    expect(placeOn(ATLAS.x)).toBe(1.5);
    expect(placeOn(ATLAS.y)).toBeNull();
  });

  it("shows a cell the paler the less sure it is", () => {
    const [row] = [...rowsFor(cell(1, 1)).values()];
    if (row === undefined) throw new Error("no row");
    expect(surenessBy("outcome")(row)).toBeCloseTo(0.75);
    expect(surenessBy("peak_tip_force")({ ...row, [CAGED_SHARE]: 0 })).toBe(0.25);
    expect(detailOf(row)).toBe("2 of 3 futures caged");
    expect(detailOf({ ...row, error: "mass must be positive" })).toBe("mass must be positive");
  });

  it("does not spread chance over all colours", () => {
    const narrow = spanOf(rowsFor(cell(0, 0), cell(1, 0, { measures: { peak_tip_force: 0.401 } })), "peak_tip_force");
    expect((narrow?.[1] ?? 0) - (narrow?.[0] ?? 0)).toBeCloseTo(0.0401);
    expect(spanOf(rowsFor(cell(0, 0), cell(1, 0, { measures: { peak_tip_force: 0.8 } })), "peak_tip_force")).toEqual([0.4, 0.8]);
    expect(spanOf(rowsFor(cell(0, 0)), "outcome")).toBeNull();
    expect(spanOf(rowsFor(cell(0, 0)), CAGED_SHARE)).toEqual([0, 1]);
  });
});

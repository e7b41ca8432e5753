import { describe, expect, it } from "vitest";
import type { History, Run } from "../../api/types";
import { curveOf, eventTime, extentOf, missingWords, nearestRow, pathOf, type OverlayCurve } from "./curves";
import { expressionOf, type Expression } from "./expression";

const HISTORY: History = {
  run_id: "A",
  columns: [
    { name: "mission.time", unit: "s" },
    { name: "mission.phase", unit: "1" },
    { name: "left.hand_force", unit: "N" },
  ],
  rows: [
    [0, 0, 0],
    [4, 0, 0],
    [5, 1, 0.5],
    [null, null, null],
    [7, 2, 0.25],
  ],
};

const RUN = { id: "A", outcome: { contacts: [{ arm: "left", start: 4.5, end: 5, peak: 0.5, planned: true }], closed_at: null } } as unknown as Run;

function read(text: string): Expression {
  const expression = expressionOf(text, new Map(HISTORY.columns.map(({ name, unit }) => [name, unit])));
  if ("fault" in expression) throw new Error(expression.fault);
  return expression;
}

const curve = (xs: number[], ys: number[]): OverlayCurve => ({ run: "A", xs: Float64Array.from(xs), ys: Float64Array.from(ys) });

describe("runs over one another", () => {
  it("lie at their first touches, motions or closures", () => {
    expect(eventTime("touch", RUN, HISTORY)).toBe(4.5);
    expect(eventTime("motion", RUN, HISTORY)).toBe(5);
    expect(eventTime("clock", RUN, HISTORY)).toBe(0);
    expect(missingWords("closure", "mission.time", RUN, HISTORY)).toBe("no closure");
    expect(missingWords("closure", "left.hand_force", RUN, HISTORY)).toBeNull();
  });

  it("begin a second before the first motion, with gaps as gaps", () => {
    const { xs, ys } = curveOf(RUN, HISTORY, read("mission.time"), read("2 * left.hand_force"), true, "touch");
    expect([...xs]).toEqual([-0.5, 0.5, Number.NaN, 2.5]);
    expect([...ys]).toEqual([0, 1, Number.NaN, 0.5]);
  });

  it("are not shifted along anything but time", () => {
    expect([...curveOf(RUN, HISTORY, read("left.hand_force"), read("mission.time"), false, "touch").xs][1]).toBe(0.5);
  });
});

describe("what is drawn of a curve", () => {
  it("has room, also of a constant", () => {
    expect(extentOf([curve([0, 1], [2, 2])])?.y).toEqual([1.9, 2.1]);
    expect(extentOf([curve([Number.NaN], [1])])).toBeNull();
  });

  it("keeps every peak that can be seen, and nothing that cannot", () => {
    const path = pathOf(curve([0, 0.1, 0.2, 0.3, 5], [0, 0, 9, 0, 0]), (x) => x, (y) => y);
    expect(path).toBe("M0.0 0.0L0.2 9.0L0.3 0.0L5.0 0.0");
  });

  it("is broken where nothing was recorded", () => {
    expect(pathOf(curve([0, 1, 2, 3], [0, Number.NaN, 2, 3]), (x) => x, (y) => y)).toBe("M0.0 0.0M2.0 2.0L3.0 3.0");
  });

  it("is read at the nearest point", () => {
    expect(nearestRow(curve([0, 1, 2], [0, 5, 0]), 1.4, null, { x: 1, y: 1 })).toBe(1);
    expect(nearestRow(curve([0, 1, 2], [0, 5, 0]), 1.4, 0, { x: 1, y: 1 })).toBe(2);
    expect(nearestRow(curve([], []), 1, null, { x: 1, y: 1 })).toBe(-1);
  });
});

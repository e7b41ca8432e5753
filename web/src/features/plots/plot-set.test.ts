import { describe, expect, it } from "vitest";
import { QUANTITIES } from "../../source/quantities";
import { PAIRS, unitOf } from "./plot-set";

const PLOTS = Object.values(PAIRS).flatMap(({ plots }) => plots);

describe("the plots", () => {
  it.each(PLOTS)("$id has curves of one unit", (plot) => {
    expect(new Set(plot.curves.map(({ quantity }) => QUANTITIES[quantity].unit))).toEqual(new Set([unitOf(plot)]));
  });

  it("have names that tell them apart", () => {
    expect(new Set(PLOTS.map(({ id }) => id)).size).toBe(PLOTS.length);
  });
});

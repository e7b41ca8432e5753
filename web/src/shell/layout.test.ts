import { describe, expect, it } from "vitest";
import { addressOf, DEFAULT_LAYOUT, layoutOf, readLayout, withSize } from "./layout";

describe("a layout", () => {
  it("is shared as an address", () => {
    const layout = { ...DEFAULT_LAYOUT, view: "plots", left: 340, plots: 60 } as const;
    expect(addressOf(layout)).toBe("#/mission?view=plots&left=340&plots=60");
    expect(layoutOf(addressOf(layout))).toEqual(layout);
    const moved = { ...layout, panels: "events.commands_parameters_outcome.problems.rehearsal" };
    expect(addressOf(moved)).toBe(`${addressOf(layout)}&panels=${moved.panels}`);
    expect(layoutOf(addressOf(moved))).toEqual(moved);
  });

  it("is asked for by the mission's address only", () => {
    expect(layoutOf("#/mission")).toBeNull();
    expect(layoutOf("#/runs?view=wall")).toBeNull();
    expect(layoutOf("#/?view=wall")?.view).toBe("wall");
  });

  it("keeps every panel of use, whatever was asked for or kept", () => {
    expect(layoutOf("#/mission?view=cinema&left=5&right=9999&plots=half")).toEqual({ ...DEFAULT_LAYOUT, left: 240, right: 720 });
    expect(readLayout("wall")).toEqual(DEFAULT_LAYOUT);
    expect(readLayout({ view: "wall", left: "wide" })).toEqual({ ...DEFAULT_LAYOUT, view: "wall" });
    expect(withSize(DEFAULT_LAYOUT, "plots", 99).plots).toBe(85);
    expect(withSize({ ...DEFAULT_LAYOUT, left: 300 }, "left", null).left).toBeNull();
  });
});

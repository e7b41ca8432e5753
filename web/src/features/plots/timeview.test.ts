import { describe, expect, it } from "vitest";
import { chosen, FOLLOW, rangeOf, timeLabels, zoomedAbout } from "./timeview";

describe("the stretch of time that is shown", () => {
  it("follows the mission, whole or its last seconds", () => {
    const whole = { ...FOLLOW, window: 0 } as const;
    expect(rangeOf(whole, 1, 0)).toEqual({ from: 0, to: 5 });
    expect(rangeOf(whole, 21, 0)).toEqual({ from: 0, to: 21 });
    expect(rangeOf({ ...FOLLOW, window: 10 }, 21, 0)).toEqual({ from: 11, to: 21 });
    expect(rangeOf({ ...FOLLOW, window: 10 }, 4, 0)).toEqual({ from: 0, to: 10 });
  });

  it("leaves out the idle time before a mission", () => {
    expect(rangeOf({ ...FOLLOW, window: 0 }, 620, 600)).toEqual({ from: 599, to: 620 });
  });

  it("stands still when paused or zoomed", () => {
    expect(rangeOf({ ...FOLLOW, window: 10, pausedAt: 15 }, 99, 0)).toEqual({ from: 5, to: 15 });
    expect(rangeOf({ ...FOLLOW, zoomed: { from: 2, to: 3 } }, 99, 0)).toEqual({ from: 2, to: 3 });
  });

  it("zooms about the cursor and never before the beginning", () => {
    expect(zoomedAbout({ from: 10, to: 20 }, 12, 0.5)).toEqual({ from: 11, to: 16 });
    expect(zoomedAbout({ from: 0, to: 10 }, 9, 2).from).toBe(0);
    expect(chosen(8, 6)).toEqual({ from: 6, to: 8 });
    expect(chosen(6, 6).to).toBeGreaterThan(6);
  });
});


describe("the times of an axis", () => {
  it("say their unit, and are minutes and seconds from two minutes on", () => {
    expect(timeLabels([0, 20, 40])).toEqual(["0", "20", "40 s"]);
    expect(timeLabels([3.4, 3.45, 3.5])).toEqual(["3.40", "3.45", "3.50 s"]);
    expect(timeLabels([0, 2.5, 5])).toEqual(["0.0", "2.5", "5.0 s"]);
    expect(timeLabels([382, 384, 386])).toEqual(["06:22", "06:24", "06:26"]);
  });
});

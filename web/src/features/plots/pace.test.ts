import { describe, expect, it } from "vitest";
import { Pace } from "./pace";

describe("the pace of drawing", () => {
  it("is thirty a second where something moves, five where only the time axis does", () => {
    const pace = new Pace();
    expect(pace.wait(1000, false)).toBe(0);
    pace.drew(1000, 2);
    expect(pace.wait(1000, false)).toBe(32);
    expect(pace.wait(1000, true)).toBe(200);
    expect(pace.wait(1032, false)).toBe(0);
  });

  it("leaves the page its time where drawing is slow, and never stops", () => {
    const pace = new Pace();
    for (let now = 0; now < 100_000; now += 1000) pace.drew(now, 12);
    expect(pace.wait(99_000, false)).toBeCloseTo(12 / 0.15, 0);
    for (let now = 0; now < 100_000; now += 1000) pace.drew(now, 5000);
    expect(pace.wait(99_000, false)).toBe(250);
  });
});

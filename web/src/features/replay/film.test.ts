import { describe, expect, it } from "vitest";
import { pictureIn } from "../scene/picture";
import { momentsOf, refusalOf } from "./film";

const PLAN = { from: 2, to: 4, speed: 1, rate: 30 };

describe("a film", () => {
  it("has its frames at even steps of mission time, from end to end", () => {
    const moments = momentsOf(PLAN);
    expect(moments).toHaveLength(61);
    expect([moments[0], moments[30], moments[60]]).toEqual([2, expect.closeTo(3, 9), expect.closeTo(4, 9)]);
    expect(momentsOf({ ...PLAN, speed: 0.5 })).toHaveLength(121);
    expect(momentsOf({ ...PLAN, speed: 10, rate: 24 }).at(-1)).toBeLessThanOrEqual(4);
  });

  it("is refused in words where it cannot be", () => {
    expect(refusalOf(PLAN, 4)).toBeNull();
    expect(refusalOf({ ...PLAN, to: 2 }, 4)).toMatch(/ends after it begins/);
    expect(refusalOf({ ...PLAN, from: -1 }, 4)).toMatch(/0 s or later/);
    expect(refusalOf({ ...PLAN, to: Number.NaN }, 4)).toMatch(/ends after it begins/);
    expect(refusalOf(PLAN, 3.5)).toBe("The run ends at 3.500 s.");
    expect(refusalOf({ from: 0, to: 3600, speed: 0.1, rate: 60 }, 3600)).toMatch(/at most 36000 frames/);
  });
});

it("a picture is told by messages of its own only", () => {
  const content = new Uint8Array([1]);
  expect(pictureIn({ scene: "picture", name: "a", content })).toEqual({ name: "a", content });
  for (const other of [null, 1, { scene: "drawn" }, { scene: "picture", name: 1, content }, { scene: "picture", name: "a", content: "x" }]) expect(pictureIn(other)).toBeNull();
});

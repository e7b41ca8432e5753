import { describe, expect, it } from "vitest";
import { readable } from "./decorations";

const label = (left: number, matters = false) => ({ left, width: 10, matters });

describe("labels of touches", () => {
  it("stand where they are read: of those that would overlap the first", () => {
    expect(readable([label(0), label(5), label(11), label(12), label(40)], 2)).toEqual([true, false, false, true, true]);
  });

  it("give way to one of an unplanned touch", () => {
    expect(readable([label(0), label(5, true), label(20)], 2)).toEqual([false, true, true]);
  });

  it("are all there where touches are far apart, in whatever order", () => {
    expect(readable([label(60), label(0), label(30, true)], 2)).toEqual([true, true, true]);
  });
});

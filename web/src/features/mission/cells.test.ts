import { describe, expect, it } from "vitest";
import { forceWords, goWords, reasonsOf, shownReasons } from "./cells";

const condition = (words: string, met: boolean) => ({ name: words, met, value: null, bound: null, unit: "", words });

describe("go or no-go", () => {
  it("is blocked before all else, and never green then", () => {
    const blocked = { next: "reset", go: false, blocked: "the mission was stopped", conditions: [condition("slow", true)] };
    expect(goWords(blocked)).toBe("Blocked");
    expect(reasonsOf(blocked)[0]).toEqual({ icon: "bar", words: "the mission was stopped" });
  });

  it("names what is unmet first", () => {
    const waiting = { next: "caging", go: false, blocked: null, conditions: [condition("slow", true), condition("absorbed", false)] };
    expect(goWords(waiting)).toBe("No go");
    expect(reasonsOf(waiting).map(({ icon, words }) => `${icon} ${words}`)).toEqual(["cross absorbed", "check slow"]);
    expect(shownReasons(reasonsOf(waiting)).map(({ words }) => words)).toEqual(["absorbed"]);
    expect(goWords({ ...waiting, go: true })).toBe("Go");
  });
});

describe("the force of a touch", () => {
  it("is never nothing", () => {
    expect(["0.0004", "0.0099", "0.0101", "1.2"].map((force) => forceWords(Number(force)))).toEqual(["< 0.01", "< 0.01", "0.01", "1.20"]);
  });
});

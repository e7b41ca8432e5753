import { describe, expect, it } from "vitest";
import { PAGES } from "../../store/route";
import { leadsOn, STEPS } from "./steps";

describe("the tour", () => {
  it("takes two minutes: at most twelve steps of at most fifty words, each on a page that there is", () => {
    expect(STEPS.length).toBeLessThanOrEqual(12);
    for (const { words, page } of STEPS) {
      expect(words.split(/\s+/).length).toBeLessThanOrEqual(50);
      expect(PAGES).toContain(page);
    }
  });

  it("begins with STOP", () => {
    expect(STEPS[0]?.target).toBe("#stop-button");
  });

  it("goes on when the capture that it asks for has begun", () => {
    const capture = STEPS.find(({ title }) => title === "Capture");
    expect(leadsOn(capture, "detumbling")).toBe(true);
    expect(leadsOn(capture, "idle")).toBe(false);
    expect(leadsOn(STEPS[0], "detumbling")).toBe(false);
  });
});

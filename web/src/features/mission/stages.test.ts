import { describe, expect, it } from "vitest";
import { stagesOf } from "./PhaseTimeline";

const states = (spans: Parameters<typeof stagesOf>[0], phase: Parameters<typeof stagesOf>[1]): string[] =>
  stagesOf(spans, phase).map((stage) => `${stage.phase} ${stage.state}`);

describe("the phase timeline", () => {
  it("tells done, now and ahead", () => {
    const spans = [
      { phase: "idle", start: 0, end: 2 },
      { phase: "detumbling", start: 2, end: 5 },
    ] as const;
    expect(states(spans, "detumbling")).toEqual(["idle done", "detumbling now", "caging ahead", "holding ahead"]);
    expect(stagesOf(spans, "detumbling")[1]?.lasted).toBe(3);
  });

  it("adds a stop, and claims no stage that was never entered", () => {
    const spans = [{ phase: "detumbling", start: 0, end: 5 }] as const;
    expect(states(spans, "stopped")).toEqual(["idle ahead", "detumbling done", "caging ahead", "holding ahead", "stopped now"]);
  });
});

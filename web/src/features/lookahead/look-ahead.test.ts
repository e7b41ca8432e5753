import { describe, expect, it } from "vitest";
import type { LookAhead } from "../../api/types";
import { lineOf, mayLookAhead, noGoOf } from "./look-ahead";

const NOTHING: LookAhead = { made: false, words: "", go_odds: 0.9, go_peak_force: null, reason: "its futures are being flown" };
const GO: LookAhead = { made: true, request: "capture", go: true, words: "Capture: 97 of 100 futures caged, peak below 0.41 N in 95 %", reason: null, go_odds: 0.9, go_peak_force: null };
const NO_GO: LookAhead = { ...GO, go: false, reason: "82 % of the futures end in a cage; go takes 90 %" };

describe("the look-ahead", () => {
  it("puts nothing in the way without one", () => {
    expect(noGoOf(null, "capture")).toBeNull();
    expect(noGoOf(NOTHING, "capture")).toBeNull();
    expect(lineOf(NOTHING)).toEqual({ verdict: "unknown", words: "No look-ahead: its futures are being flown." });
  });

  it("warns of the request that it is of, with the reason", () => {
    expect(noGoOf(GO, "capture")).toBeNull();
    expect(noGoOf(NO_GO, "capture")).toBe("No go: 82 % of the futures end in a cage; go takes 90 %.");
    expect(noGoOf(NO_GO, "release")).toBeNull();
    expect(lineOf(NO_GO).verdict).toBe("no-go");
  });

  it("is asked for only while a capture could be", () => {
    expect(mayLookAhead("live", { commands: { capture: null } })).toBe(true);
    expect(mayLookAhead("live", { commands: { capture: "A sequence is under way." } })).toBe(false);
    expect(mayLookAhead("stale", { commands: { capture: null } })).toBe(false);
    expect(mayLookAhead("live", null)).toBe(false);
  });
});

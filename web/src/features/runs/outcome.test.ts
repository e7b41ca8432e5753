import { describe, expect, it } from "vitest";
import type { Outcome } from "../../api/types";
import { verdictOf } from "./outcome";

const outcome = (more: Partial<Outcome>): Outcome =>
  ({ caged: true, outcome: "caged_force_reduced", at_first_closure: "caged_force_reduced", ...more }) as Outcome;

describe("how a capture ended", () => {
  it("is told for the locked arms", () => {
    const blow = outcome({ outcome: "caged_force_not_reduced" });
    expect(verdictOf(blow)).toMatchObject({ tone: "fair", headline: "Caged, force not reduced" });
    expect(verdictOf(outcome({})).tone).toBe("good");
  });

  it("never calls a target caged that can get out", () => {
    const loose = outcome({ caged: false });
    expect(verdictOf(loose)).toMatchObject({ tone: "bad", headline: "Closed, but not caged" });
    const gone = outcome({ caged: false, outcome: "ejection" });
    expect(verdictOf(gone).headline).toBe("Target ejected");
  });
});

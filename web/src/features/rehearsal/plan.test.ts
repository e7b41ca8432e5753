import { describe, expect, it } from "vitest";
import type { UncertaintyField } from "../../api/types";
import { faultsOf, PLAN, rehearsalOf, requestOf } from "./plan";

const FIELDS: UncertaintyField[] = [
  { name: "friction", unit: "1", description: "", source: "", default: 0.2, minimum: 0, maximum: 3 },
  { name: "delay", unit: "s", description: "", source: "", default: 1e-3, minimum: 0, maximum: 0.1 },
];

const LIVE = { run: null, at: null, phase: "idle" } as const;

describe("what is asked of a rehearsal", () => {
  it("begins with what comes next, or goes on with what is under way", () => {
    expect(requestOf("next", "idle")).toBe("capture");
    expect(requestOf("next", "caging")).toBeNull();
    expect(requestOf("cage", "detumbling")).toBe("cage");
    expect(requestOf("continue", "idle")).toBeNull();
  });

  it("names only what differs from the service's defaults", () => {
    const plan = { ...PLAN, uncertainty: { friction: "0.20", delay: "0.005" } };
    expect(rehearsalOf(plan, FIELDS, LIVE, {}).uncertainty).toEqual({ delay: 0.005 });
  });

  it("begins live, or at a moment of a run, each for itself", () => {
    const [live, stored] = [LIVE, { run: "a", at: 2.5, phase: "detumbling" as const }].map((beginning) => rehearsalOf(PLAN, FIELDS, beginning, {}));
    expect(live).toMatchObject({ source: "live", request: "capture" });
    expect(stored).toMatchObject({ source: { run: "a", at: 2.5 }, request: null });
    expect(stored?.asker).not.toBe(live?.asker);
  });

  it("is refused at the field that is wrong", () => {
    const faults = faultsOf({ ...PLAN, futures: "0", seed: "-1", uncertainty: { delay: "0.5", friction: "much" } }, FIELDS);
    expect(faults.get("futures")).toBe("must be from 1 to 2000");
    expect(faults.get("seed")).toBe("must be at least 0");
    expect(faults.get("delay")).toBe("must be from 0 to 0.1 s");
    expect(faults.get("friction")).toContain("is not a number");
    expect(faultsOf(PLAN, FIELDS).size).toBe(0);
  });
});

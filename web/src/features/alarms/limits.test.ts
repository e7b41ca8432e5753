import { describe, expect, it } from "vitest";
import { limitsOf } from "./limits";

const BEFORE = { watch: 1, warning: 2, critical: null, hysteresis: 0.1 };

describe("limits that are typed", () => {
  it("are kept in SI, with what was not edited", () => {
    expect(limitsOf(BEFORE, { watch: "90" }, 180 / Math.PI)).toEqual({ ...BEFORE, watch: Math.PI / 2 });
  });

  it("have no level where nothing stands", () => {
    expect(limitsOf(BEFORE, { warning: " " }, 1)).toEqual({ ...BEFORE, warning: null });
  });

  it("say what is wrong with them", () => {
    expect(limitsOf(BEFORE, { critical: "0,5" }, 1)).toEqual({ fault: "critical: write 0.5: the decimal sign is a point" });
    expect(limitsOf(BEFORE, { hysteresis: "" }, 1)).toEqual({ fault: "hysteresis: a number is missing" });
    expect(limitsOf(BEFORE, { hysteresis: "-1" }, 1)).toEqual({ fault: "hysteresis: must be at least 0" });
  });
});

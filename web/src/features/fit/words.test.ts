import { describe, expect, it } from "vitest";
import { digits, missBars, peakRows, residualPoints, runsOf, runWords, statusWords, uncertaintyTexts, valueRow, withRole, type Channel, type Fitted } from "./words";
import type { FitResult } from "../../api/types";

const STIFFNESS: Fitted = {
  name: "contact.stiffness", unit: "N/m", description: "k_p", nominal: 800, spread: 800, value: 1100.4, standard_error: 7, low: 1086.7, high: 1114.1,
  told: true, why_not: null, in_configuration: true,
}; // prettier-ignore

describe("a value", () => {
  it("has its interval where the run tells it, and its unit beside its name", () => {
    expect(valueRow(STIFFNESS)).toMatchObject({ name: "contact.stiffness [N/m]", nominal: "800", value: "1100.4", interval: "1086.7 to 1114.1" });
  });

  it("has none where the run does not, and says why", () => {
    const untold = { ...STIFFNESS, told: false, low: null, high: null, standard_error: null, why_not: "no hand touches" };
    expect(valueRow(untold)).toMatchObject({ value: null, interval: null, title: "no hand touches" });
  });

  it("is written with the digits that count", () => {
    expect(digits(0.00123456)).toBe("0.001235");
    expect(digits(-12.3456, 2)).toBe("−12");
  });
});

describe("the miss", () => {
  const miss = { run: "r", time: 3.5, arm: "right", nominal: 1.2, fitted: 4.1, measured: 4.4, unexplained: 0.3, words: "", parts: [{ name: "contact.stiffness", part: 3.4 }, { name: "contact.damping", part: -0.5 }] };

  it("goes from what was foretold to what was measured, part by part", () => {
    const bars = missBars(miss);
    expect(bars.map(({ name, kind }) => [name, kind])).toEqual([
      ["nominal", "level"],
      ["contact.stiffness", "more"],
      ["contact.damping", "less"],
      ["unexplained", "more"],
      ["measured", "level"],
    ]);
    const [nominal, stiffness, damping] = bars;
    expect(stiffness?.left).toBeCloseTo(nominal?.width ?? 0);
    expect((damping?.left ?? 0) + (damping?.width ?? 0)).toBeCloseTo((stiffness?.left ?? 0) + (stiffness?.width ?? 0));
    expect(bars.every(({ left, width }) => left >= 0 && left + width <= 1 + 1e-9)).toBe(true);
    expect(damping?.words).toBe("−0.5 N");
  });
});

describe("what is left of a reading", () => {
  const channel: Channel = { run: "r", name: "target.x", unit: "m", rms: 1, rms_nominal: 2, deviation: 1, time: [0, 1, 2], measured: [1, 0, -1], predicted: [0, 0, 0] };

  it("is drawn about the middle, with two deviations either way", () => {
    const { points, band } = residualPoints(channel, 100, 60);
    expect(points).toBe("M0.0 20.0h.1M50.0 30.0h.1M100.0 40.0h.1");
    expect(band[0]).toBeCloseTo(10);
    expect(band[1]).toBeCloseTo(50);
  });
});

describe("a fit under way", () => {
  const detail = { status: "running", note: "free flight", progress: { done: 120, total: 1000, wall_time: 3.2 } };

  it("says what is being done", () => {
    expect(statusWords(detail as never)).toBe("free flight, 3 s");
    expect(statusWords({ ...detail, status: "failed", note: "no ticks" } as never)).toBe("failed: no ticks");
  });
});

it("hands its errors to the form of rehearsals as text", () => {
  expect(uncertaintyTexts({ contact_stiffness: 0.0123456, friction: 0.01 })).toEqual({ contact_stiffness: "0.0123", friction: "0.01" });
});

describe("other runs", () => {
  it("are fitted too, held out, or neither", () => {
    const roles = withRole(withRole(new Map(), "one", "fitted"), "other", "held out");
    expect([runsOf(roles, "fitted"), runsOf(roles, "held out")]).toEqual([["one"], ["other"]]);
    expect(runsOf(withRole(roles, "one", "held out"), "held out")).toEqual(["one", "other"]);
    expect([...withRole(roles, "one", null).keys()]).toEqual(["other"]);
  });

  it("are told apart by name, configuration and seed", () => {
    const run = { id: "20261201T080000000-4f9a2c", name: "", configuration: "testbed", seed: 3 };
    expect(runWords(run)).toBe("…4f9a2c, testbed, seed 3");
    expect(runWords({ ...run, name: "hard blow" })).toBe("hard blow, testbed, seed 3");
  });
});

describe("peak forces", () => {
  const touch = { run: "20261201T080000000-4f9a2c", time: 3.456, arm: "right", measured: 1, nominal: 2, fitted: 3 };
  const result = (heldOut: readonly (typeof touch)[]): FitResult =>
    ({ runs: [touch.run], held_out: heldOut.map(({ run }) => run), touch_predictions: [touch], held_out_predictions: heldOut }) as unknown as FitResult;

  it("name the run only where there are several", () => {
    expect(peakRows(result([])).map(({ words }) => words)).toEqual(["3.46 s, right"]);
    const rows = peakRows(result([{ ...touch, run: "20261201T080000000-81b0e2" }]));
    expect(rows.map(({ words, heldOut }) => [words, heldOut])).toEqual([["…4f9a2c, 3.46 s, right", false], ["…81b0e2, 3.46 s, right", true]]);
    expect(new Set(rows.map(({ key }) => key)).size).toBe(2);
  });
});

import { describe, expect, it } from "vitest";
import type { RehearsalResult } from "../../api/types";
import type { Config } from "../../source/source";
import { caseInForce, predictionOf } from "./prediction";

const fan = (median: number) => ({ quantity: "left.force", unit: "N", times: [3], low: [0], median: [median], high: [2] });
const RESULT = { time: 3, request: "capture", changes: { "published.impedance.damping": 6 }, as_it_is: { fans: [fan(1)] }, as_changed: { fans: [fan(1.5)] } } as unknown as RehearsalResult;
const configOf = (damping: number): Config => ({ published: { impedance: { damping } } }) as unknown as Config;

describe("what a mission was predicted to do", () => {
  it("is as changed once the changes are in force", () => {
    expect(caseInForce(RESULT, configOf(1.5))).toBe("as_it_is");
    expect(caseInForce(RESULT, configOf(6))).toBe("as_changed");
    expect(caseInForce(RESULT, null)).toBe("as_it_is");
    expect(caseInForce({ ...RESULT, as_changed: null, changes: {} }, configOf(6))).toBe("as_it_is");
  });

  it("has the bands of that case", () => {
    expect(predictionOf(RESULT, configOf(6), null).bands.get("leftForce")?.median).toEqual([1.5]);
    expect(predictionOf(RESULT, configOf(1.5), null)).toMatchObject({ words: "as it is", from: 3, requested: true });
  });
});

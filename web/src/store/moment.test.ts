import { describe, expect, it } from "vitest";
import { momentOf, withMoment } from "./moment";

describe("the moment in an address", () => {
  it("is read with the stretch of the plots", () => {
    expect(momentOf("#/runs/A?t=12.3&from=10&to=15.5")).toEqual({ time: 12.3, range: { from: 10, to: 15.5 } });
  });

  it("is nothing where the address says nothing, or what cannot be", () => {
    for (const hash of ["#/runs/A", "#/runs/A?t=soon&from=5", "#/runs/A?t=-1&from=5&to=5", "#/runs/A?t=&to=3", "#/runs/A?t=Infinity"]) {
      expect(momentOf(hash)).toEqual({ time: null, range: null });
    }
  });

  it("is written beside what else the address says, to a tick", () => {
    expect(withMoment("#/runs/A/B?text=damping", { time: 1.23456 })).toBe("#/runs/A/B?text=damping&t=1.235");
    expect(withMoment("#/runs/A?t=3", { range: { from: 1, to: 2 } })).toBe("#/runs/A?t=3&from=1&to=2");
    expect(withMoment("#/runs/A?t=3&from=1&to=2", { range: null })).toBe("#/runs/A?t=3");
    expect(withMoment("#/runs/A?t=3", { time: null })).toBe("#/runs/A");
  });
});

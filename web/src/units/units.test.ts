import { describe, expect, it } from "vitest";
import { clock, duration, fixed, plain, shown } from "./units";

describe("units on the screen", () => {
  it("shows angles and rates in the preferred unit and leaves forces alone", () => {
    expect(shown("rad/s", "deg").factor * Math.PI).toBeCloseTo(180);
    expect(shown("rad", "rad")).toEqual({ factor: 1, unit: "rad" });
    expect(shown("N", "deg")).toEqual({ factor: 1, unit: "N" });
    expect(shown("1", "rad").unit).toBe("");
  });

  it("writes a true minus and no negative zero", () => {
    expect(fixed(-1.234, 2)).toBe("\u22121.23");
    expect(fixed(-0.001, 2)).toBe("0.00");
    expect(fixed(Number.NaN, 2)).toBe("—");
  });

  it("keeps what was typed", () => {
    expect(plain(0.1 + 0.2)).toBe("0.3");
    expect(plain(9.32724e-3)).toBe("0.00932724");
    expect(plain(1e-4)).toBe("1e-4");
    expect(plain(5 * (Math.PI / 180) * (180 / Math.PI))).toBe("5");
  });

  it("says a duration in seconds, from a minute on in minutes, from an hour on in hours", () => {
    expect(duration(0)).toBe("0.0 s");
    expect(duration(12.34)).toBe("12.3 s");
    expect(duration(0.256, 2)).toBe("0.26 s");
    expect(duration(59.96)).toBe("1 min 0.0 s");
    expect(duration(83.45, 2)).toBe("1 min 23.45 s");
    expect(duration(3599, 0)).toBe("59 min 59 s");
    expect(duration(3900)).toBe("1 h 5 min");
    expect(duration(Number.NaN)).toBe("—");
  });

  it("rounds the clock once", () => {
    expect(clock(0)).toBe("00:00.000");
    expect(clock(83.4567)).toBe("01:23.457");
    expect(clock(59.9996)).toBe("01:00.000");
    expect(clock(61.2, 0)).toBe("01:01");
  });
});

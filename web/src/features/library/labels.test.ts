import { describe, expect, it } from "vitest";
import { changeWords, changesTitle, configurationWords, damageWords, statusWords } from "./labels";

const damping = { path: "published.impedance.damping", title: "Virtual damping", unit: "N s/m", configured: 1.5, value: 3 };

describe("a run in words", () => {
  it("tells what was changed, with its unit", () => {
    expect(changeWords(damping)).toBe("damping 1.5 → 3 N·s/m");
    expect(changeWords({ path: "contact.corner", title: "Corner", unit: "1", configured: "face", value: "radial" })).toBe("corner face → radial");
    expect(changeWords({ path: "target.vertices", title: "Vertices", unit: "m", configured: [[0, 0], [1, 0], [0, 1]], value: [[0, 0], [0.2, 0], [0, 0.1]] })).toBe(
      "vertices 0, 0; 1, 0; 0, 1 → 0, 0; 0.2, 0; 0, 0.1 m",
    );
    expect(changesTitle([damping])).toContain("published.impedance.damping");
  });

  it("names the configuration that it began as", () => {
    expect(configurationWords({ configuration: "published (edited)", direct: true })).toBe("published, direct");
  });
});

describe("how a run without a verdict ended", () => {
  const live = { status: "cancelled", kind: "live", integrity: "complete", note: null } as const;

  it("is told apart: cut off, ended by a reset, stopped", () => {
    expect(statusWords({ ...live, status: "failed", integrity: "recovered" })).toBe("cut off");
    expect(statusWords({ ...live, note: "cut off: the service ended" })).toBe("cut off");
    expect(statusWords({ ...live, note: "ended by reset" })).toBe("ended by reset");
    expect(statusWords({ ...live, note: "ended by STOP" })).toBe("ended by STOP");
  });

  it("is said for runs of 0.1.0, too, and a failure stays a failure", () => {
    expect(statusWords(live)).toBe("ended early");
    expect(statusWords({ ...live, status: "failed", note: "the robot is silent" })).toBe("failed");
    expect(statusWords({ ...live, kind: "scripted" })).toBe("cancelled");
  });
});

describe("damage to a run's events", () => {
  it("is counted, or said of all", () => {
    expect(damageWords(1)).toContain("One event of this run is damaged");
    expect(damageWords(4)).toContain("4 events of this run are damaged");
    expect(damageWords(null)).toContain("cannot be read");
  });
});

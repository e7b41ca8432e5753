import { describe, expect, it } from "vitest";
import { changesTitle, changeWords, configurationWords } from "./words";

const damping = { path: "control.impedance.damping", title: "Virtual damping", unit: "N s/m", configured: 1.5, value: 3 };

describe("a run in words", () => {
  it("tells what was changed, with its unit", () => {
    expect(changeWords(damping)).toBe("damping 1.5 → 3 N·s/m");
    expect(changeWords({ path: "contact.corner", title: "Corner", unit: "1", configured: "face", value: "radial" })).toBe("corner face → radial");
    expect(changesTitle([damping])).toContain("control.impedance.damping");
  });

  it("names the configuration that it began as", () => {
    expect(configurationWords({ configuration: "published (edited)", direct: true })).toBe("published, direct");
  });
});

import { describe, expect, it } from "vitest";
import { found, stepped, type Entry } from "./entries";

const entry = (group: string, label: string, hint = "", words = ""): Entry => ({ id: label, group, label, hint, words, run: () => undefined });

const ENTRIES = [
  entry("Pages", "Runs"),
  entry("Parameters", "Virtual damping of the hand", "published.impedance.damping"),
  entry("Parameters", "Damping", "contact.damping"),
  entry("Words", "Cage margin", "By how much the hands' surfaces would have to give way"),
];
const PAGES = new Set(["Pages"]);
const labels = (text: string): string[] => found(ENTRIES, text, PAGES).map(({ label }) => label);

describe("the command palette", () => {
  it("shows what is usual before anything was typed", () => {
    expect(labels("  ")).toEqual(["Runs"]);
  });

  it("puts first what begins with the text, and finds paths and meanings too", () => {
    expect(labels("damp")).toEqual(["Damping", "Virtual damping of the hand"]);
    expect(labels("IMPEDANCE damping")).toEqual(["Virtual damping of the hand"]);
    expect(labels("give way")).toEqual(["Cage margin"]);
    expect(labels("cage_margin")).toEqual(["Cage margin"]);
    expect(labels("nothing of it")).toEqual([]);
  });

  it("goes round its ends", () => {
    expect([stepped(0, "ArrowUp", 3), stepped(2, "ArrowDown", 3), stepped(1, "a", 3), stepped(0, "ArrowDown", 0)]).toEqual([2, 0, 1, 0]);
  });
});

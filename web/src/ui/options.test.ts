import { describe, expect, it } from "vitest";
import { longestOf, optionsOf, suggestionsFor, typedTo } from "./options";

const plain = (key: string) => ({ key, ctrlKey: false, metaKey: false, altKey: false });
const speeds = optionsOf(["Fast", "Slow", { value: "still", label: "Standing", disabled: true }, "Fastest"]);

describe("a drop-down", () => {
  it("goes to the next option that begins with a typed letter, round the end, past what cannot be chosen", () => {
    expect(typedTo(plain("f"), speeds, 0)).toBe(3);
    expect(typedTo(plain("F"), speeds, 3)).toBe(0);
    expect(typedTo(plain("s"), speeds, -1)).toBe(1);
    expect(typedTo(plain("s"), speeds, 1)).toBe(1);
    expect(typedTo(plain("x"), speeds, 0)).toBeNull();
  });

  it("goes to both ends, and leaves other keys alone", () => {
    expect([plain("Home"), plain("End")].map((key) => typedTo(key, speeds, 1))).toEqual([0, 3]);
    for (const key of ["Escape", "Enter", " ", "ArrowDown"]) expect(typedTo(plain(key), speeds, 0)).toBeNull();
    expect(typedTo({ ...plain("f"), ctrlKey: true }, speeds, 0)).toBeNull();
    expect(typedTo(plain("f"), [], -1)).toBeNull();
  });

  it("is as wide as its longest option", () => {
    expect(longestOf(speeds)).toBe("Standing");
    expect(longestOf([])).toBe("");
  });
});

describe("suggestions", () => {
  const paths = [
    { value: "published.impedance.mass", label: "virtual mass [kg]" },
    { value: "target.mass", label: "mass of the target [kg]" },
    { value: "target.size", label: "length of a side [m]" },
  ];

  it("are those that the text is part of, by name or by what they are", () => {
    expect(suggestionsFor("MASS", paths).map(({ value }) => value)).toEqual(["published.impedance.mass", "target.mass"]);
    expect(suggestionsFor(" side", paths).map(({ value }) => value)).toEqual(["target.size"]);
    expect(suggestionsFor("", paths)).toHaveLength(3);
    expect(suggestionsFor("nothing of it", paths)).toEqual([]);
  });
});

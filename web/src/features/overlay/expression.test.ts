import { describe, expect, it } from "vitest";
import { expressionOf } from "./expression";

const UNITS = new Map([["left.hand_force", "N"], ["right.hand_force", "N"], ["left.joint_rate.1", "rad/s"], ["mission.time", "s"]]);
const VALUES: Readonly<Record<string, number>> = { "left.hand_force": 3, "right.hand_force": 4, "left.joint_rate.1": 0.5, "mission.time": 10 };

function value(text: string): number {
  const read = expressionOf(text, UNITS);
  if ("fault" in read) throw new Error(read.fault);
  return read.of((name) => VALUES[name] ?? Number.NaN);
}

function unit(text: string): string | null {
  const read = expressionOf(text, UNITS);
  if ("fault" in read) throw new Error(read.fault);
  return read.unit;
}

describe("an expression over columns", () => {
  it("reads a column by its name, with the parts that are figures", () => {
    expect(value("left.joint_rate.1")).toBe(0.5);
  });

  it("is worked out as in a book", () => {
    expect(value("1 + 2 * 3")).toBe(7);
    expect(value("(1 + 2) * 3")).toBe(9);
    expect(value("8 - 3 - 2")).toBe(3);
    expect(value("16 / 4 / 2")).toBe(2);
    expect(value("-2 ^ 2")).toBe(-4);
    expect(value("2 ^ 3 ^ 2")).toBe(512);
    expect(value("2 * -3")).toBe(-6);
    expect(value("1.5e-3 * 2")).toBe(0.003);
    expect(value("cos(pi)")).toBe(-1);
  });

  it("calls functions of one or more values", () => {
    expect(value("hypot(left.hand_force, right.hand_force)")).toBe(5);
    expect(value("max(left.hand_force, right.hand_force, 4.5)")).toBe(4.5);
  });

  it("carries units where they are sure", () => {
    expect(unit("max(left.hand_force, right.hand_force)")).toBe("N");
    expect(unit("left.hand_force - right.hand_force")).toBe("N");
    expect(unit("2 * left.hand_force / 3")).toBe("N");
    expect(unit("left.hand_force * right.hand_force")).toBeNull();
    expect(unit("left.hand_force + mission.time")).toBeNull();
    expect(unit("1 / mission.time")).toBeNull();
  });

  it("names the columns that it needs, each once", () => {
    const read = expressionOf("left.hand_force + left.hand_force * mission.time", UNITS);
    expect(read).toMatchObject({ columns: ["left.hand_force", "mission.time"] });
  });

  it.each([
    ["left.force", '"left.force" is no column of the log'],
    ["left.hand_force +", "it ends too early"],
    ["(left.hand_force", '")" is missing'],
    ["left.hand_force mission.time", '"mission.time" is not expected there'],
    ["2 & 3", '"& 3" is not understood'],
    ["sqrt(1, 2)", "sqrt takes one value"],
    ["constructor(1)", '"constructor" is none of the functions'],
    ["", "Name a column"],
    ["(".repeat(390), "it ends too early"],
  ])("says what is wrong with %s", (text, words) => {
    const read = expressionOf(text, UNITS);
    expect("fault" in read ? read.fault : "").toContain(words);
  });
});

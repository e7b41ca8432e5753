import { describe, expect, it } from "vitest";
import cases from "./numbers.cases.json";
import { readList, readNumber, readWhole } from "./numbers";

describe("a number that a person types", () => {
  // tests/unit/test_typed.py reads the same cases on the command line.
  it.each(cases.numbers)("$text", ({ text, value, error }) => {
    const read = readNumber(text);
    if (error === undefined) expect("value" in read && read.value + 0).toBe(value);
    else expect(read).toEqual({ error });
  });

  it("is whole, and held exactly, where it must be", () => {
    expect(readWhole("1e3")).toEqual({ value: 1000 });
    expect(readWhole("1.5")).toEqual({ error: "takes whole numbers" });
    expect(readWhole("9223372036854775807")).toHaveProperty("error", expect.stringContaining("9007199254740991"));
  });
});

describe("a list that a person types", () => {
  it.each<[string, (number | string)[]]>([
    ["1", [1]],
    ["1, 2.5,3", [1, 2.5, 3]],
    ["0.05,0.1,0.5", [0.05, 0.1, 0.5]],
    ["1 2  3", [1, 2, 3]],
    ["0.1 , 0.2", [0.1, 0.2]],
    ["1, 2,", [1, 2]],
    ["-1,-2", [-1, -2]],
    ["1e3, .5 5.", [1000, 0.5, 5]],
    ["０．１、０．２", [0.1, 0.2]],
    ["face, radial", ["face", "radial"]],
    ["face,radial", ["face", "radial"]],
    ["1, 200", [1, 200]],
  ])("%s", (text, values) => {
    expect(readList(text)).toEqual({ values });
  });

  it.each([
    ["0,5", 'write 0.5: the decimal sign is a point; for two values write "0, 5"'],
    ["0,05, 0,1", "write 0.05: the decimal sign is a point"],
    ["0.1, 0,5", 'write 0.5: the decimal sign is a point; for two values write "0, 5"'],
    [",5", "write 0.5: the decimal sign is a point"],
    ["1,000", 'write 1000 or 1.000: the decimal sign is a point, and nothing separates thousands'],
    ["1,2,3", '"1,2,3" can be read in two ways; write "1, 2, 3" with a space after each comma, and a point as the decimal sign'],
    ["0,5,1,5", '"0,5,1,5" can be read in two ways; write "0, 5, 1, 5" with a space after each comma, and a point as the decimal sign'],
    ["1,000,000", "write 1000000: nothing separates thousands"],
    ["1,000.5", "write 1000.5: nothing separates thousands"],
    ["1 000", "write 0, without the zero in front"],
    ["1\u202f000", '"1\u202f000": nothing separates thousands; separate values by a comma and a space'],
    ["", "values are missing"],
    [" , ", "a value is missing beside a comma"],
    ["1,, 2", "a value is missing beside a comma"],
    ["1; 2", '"1;" is not a number; write it as 5, 0.5 or 5e-1'],
    ["1, six", '"six" is not a number'],
    ["nan", '"nan" is not a finite number'],
    ["0.5 N", '"N" is not a number'],
  ])("%s is refused", (text, error) => {
    expect(readList(text)).toEqual({ error });
  });
});

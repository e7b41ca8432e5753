import { describe, expect, it } from "vitest";
import type { Parameter } from "../../api/types";
import { boundsText, changesOf, draftTowards, draftWith, fieldText, found, meaning, nested, nudged, patchOf, readDraft, settled, undoOf, unsoundFields, valueAt } from "./draft";

function parameter(path: string, more: Partial<Parameter> = {}): Parameter {
  const name = path.split(".").at(-1) ?? "";
  const group = path.slice(0, -name.length - 1);
  return { path, group, name, title: name, group_title: group, description: "", unit: "1", default: 0, source: "", live: true, type: "number", choice_titles: {}, ...more };
}

const damping = parameter("published.impedance.damping", { unit: "N s/m", minimum: 0, maximum: 1e4 });
const mass = parameter("published.impedance.mass", { unit: "kg", exclusive_minimum: 0, maximum: 100 });
const tilt = parameter("published.touch.hand_tilt", { unit: "rad", minimum: 0, maximum: 0.7 });
const config = { published: { impedance: { damping: 1.5, mass: 0.1 }, touch: { hand_tilt: 0.08726646259971647 } } };

describe("what a person can take back", () => {
  const applied = [{ parameter: damping, from: 1.5, to: 3 }, { parameter: mass, from: 0.1, to: 0.2 }];

  it("is what was applied, as far as it still stands", () => {
    const now = { published: { impedance: { damping: 3, mass: 0.5 } } };
    expect(undoOf(applied, now)).toEqual([{ parameter: damping, from: 3, to: 1.5 }]);
    expect(undoOf(applied, config)).toEqual([]);
  });

  it("outlives a reload as a draft, as far as it is one", () => {
    const draft = { [damping.path]: { text: "3", angles: "rad" } };
    expect(readDraft({ ...draft, other: { text: 3, angles: "rad" }, more: null, third: { text: "1", angles: "grad" } })).toEqual(draft);
    expect(readDraft("nonsense")).toEqual({});
  });
});

describe("staged edits", () => {
  it("take proposed values beside what is staged, in the unit of the form", () => {
    const old = { [mass.path]: { text: "0.2", angles: "rad" }, [damping.path]: { text: "7", angles: "rad" } } as const;
    const draft = draftWith(old, { [damping.path]: 1.5, [tilt.path]: 0.17453292519943295 }, [damping, mass, tilt], config, "deg");
    expect(draft).toEqual({ [mass.path]: { text: "0.2", angles: "rad" }, [tilt.path]: { text: "10", angles: "deg" } });
  });

  it("hold only what differs, and nest what is sent", () => {
    const draft = { [damping.path]: { text: "3", angles: "rad" }, [mass.path]: { text: "0.10", angles: "rad" } } as const;
    const changes = changesOf(draft, [damping, mass], config);
    expect(changes.map((change) => [change.parameter.path, change.from, change.to])).toEqual([[damping.path, 1.5, 3]]);
    expect(patchOf(changes)).toEqual({ published: { impedance: { damping: 3 } } });
  });

  it("make a preset of what is in force: what differs is staged, in the unit on the screen", () => {
    const wanted = { published: { impedance: { damping: 3, mass: 0.1 }, touch: { hand_tilt: 0.17453292519943295 } } };
    const draft = draftTowards(wanted, [damping, mass, tilt], config, "deg");
    expect(draft).toEqual({ [damping.path]: { text: "3", angles: "deg" }, [tilt.path]: { text: "10", angles: "deg" } });
    expect(changesOf(draft, [damping, mass, tilt], config).map(({ to }) => to)).toEqual([3, expect.closeTo(0.17453, 5)]);
    expect(draftTowards(config, [damping, mass, tilt], config, "rad")).toEqual({});
  });

  it("are kept as a tree, the later of two values of one path", () => {
    expect(nested([["a.b", 1], ["a.c", 2], ["a.b", 3]])).toEqual({ a: { b: 3, c: 2 } });
  });

  it("are gone when a field is left that says what is in force anyway", () => {
    const same = { [damping.path]: { text: "1.50", angles: "rad" } } as const;
    expect(settled(same, damping, config)).toEqual({});
    const other = { [damping.path]: { text: "1.6", angles: "rad" } } as const;
    expect(settled(other, damping, config)).toBe(other);
  });

  it("leave an angle alone that was only looked at in degrees", () => {
    const text = fieldText(tilt, valueAt(config, tilt.path) ?? 0, "deg");
    expect(text).toBe("5");
    expect(changesOf({ [tilt.path]: { text, angles: "deg" } }, [tilt], config)).toEqual([]);
    const [change] = changesOf({ [tilt.path]: { text: "10", angles: "deg" } }, [tilt], config);
    expect(change?.to).toBeCloseTo(0.1745, 4);
  });

  it("say what is wrong, with the bound in the unit on the screen", () => {
    expect(meaning(mass, "0", "rad")).toEqual({ error: "must be greater than 0 kg" });
    expect(meaning(damping, "-1", "rad")).toEqual({ error: "must be at least 0 N·s/m" });
    expect(meaning(tilt, "60", "deg")).toEqual({ error: "must be at most 40.10705 °" });
    expect(meaning(mass, "abc", "rad")).toEqual({ error: '"abc" is not a number; write it as 5, 0.5 or 5e-1' });
    expect(meaning(mass, "1,000", "rad")).toHaveProperty("error", expect.stringContaining("write 1000 or 1.000"));
    expect(meaning(parameter("simulation.seed", { type: "integer" }), "1.5", "rad")).toEqual({ error: "takes whole numbers" });
    expect(unsoundFields({ [mass.path]: { text: "x", angles: "rad" } }, [mass])).toEqual([mass]);
  });
});

describe("a list of points", () => {
  const vertices = parameter("target.vertices", { type: "points", unit: "m", minimum: -10, maximum: 10, fewest: 3, most: 12 });
  const inForce = { target: { vertices: [[0, 0], [0.2, 0], [0, 0.1]] } };
  const draft = (text: string) => ({ [vertices.path]: { text, angles: "deg" } }) as const;

  it("stands in its field as it is typed, and is sent as pairs", () => {
    const text = fieldText(vertices, valueAt(inForce, vertices.path) ?? 0, "deg");
    expect(text).toBe("0, 0; 0.2, 0; 0, 0.1");
    expect(changesOf(draft(text), [vertices], inForce)).toEqual([]);
    expect(settled(draft(text), vertices, inForce)).toEqual({});
    const changes = changesOf(draft("0 0\n0.2 0\n0 0.2"), [vertices], inForce);
    expect(patchOf(changes)).toEqual({ target: { vertices: [[0, 0], [0.2, 0], [0, 0.2]] } });
    expect(draftTowards({ target: { vertices: [[0, 0], [1, 0], [0, 1], [-1, 0]] } }, [vertices], inForce, "rad")).toEqual({
      [vertices.path]: { text: "0, 0; 1, 0; 0, 1; -1, 0", angles: "rad" },
    });
  });

  it("says what is wrong with it", () => {
    expect(meaning(vertices, "0, 0; 1, 0", "rad")).toEqual({ error: "must be at least 3 points" });
    expect(meaning(vertices, "1, 2;".repeat(13), "rad")).toEqual({ error: "must be at most 12 points" });
    expect(meaning(vertices, "0, 0; 11, 0; 0, 1", "rad")).toEqual({ error: "coordinates must be at most 10 m" });
    expect(meaning(vertices, "0, 0; 1", "rad")).toHaveProperty("error", expect.stringContaining('point 2, "1"'));
    expect(boundsText(vertices, "rad")).toBe("3 to 12 points, from -10, up to 10 m");
  });
});

describe("fields", () => {
  it("tell their bounds", () => {
    expect(boundsText(mass, "rad")).toBe("above 0, up to 100 kg");
    expect(boundsText(parameter("a.b"), "rad")).toBe("none");
  });

  it("step by their second digit", () => {
    expect(nudged("0.10", 1)).toBe("0.11");
    expect(nudged("1.5", -1)).toBe("1.4");
    expect(nudged("10", 1)).toBe("11");
    expect(nudged("0", 1)).toBe("0.1");
    expect(nudged("abc", 1)).toBe("abc");
  });

  it("are found by any of their words", () => {
    expect(found([damping, mass, tilt], "impedance mass")).toEqual([mass]);
    expect(found([damping, mass, tilt], "hand tilt")).toEqual([tilt]);
    expect(found([damping, mass], "")).toHaveLength(2);
    const method = parameter("method", { type: "choice", choices: ["published"], choice_titles: { published: "Detumbling by absorbed touches" } });
    expect(found([damping, method], "absorbed")).toEqual([method]);
  });
});

import { describe, expect, it } from "vitest";
import type { Parameter } from "../../api/types";
import { PLAN } from "../rehearsal/plan";
import { axisFor, rangeAbout, readAtlasDraft, stateIn, usualPaths, type AtlasDraft } from "./request";

function parameter(path: string, more: Partial<Parameter> = {}): Parameter {
  const name = path.split(".").at(-1) ?? "";
  const group = path.slice(0, -name.length - 1);
  return { path, group, name, title: name, group_title: group, description: "", unit: "1", default: 0, source: "", live: true, type: "number", choice_titles: {}, ...more };
}

const damping = parameter("published.impedance.damping", { minimum: 0, maximum: 1e4 });
const stiffness = parameter("published.impedance.stiffness", { minimum: 0, maximum: 1e4 });
const method = parameter("method", { type: "choice", choices: ["published"] });
const PARAMETERS = [method, parameter("published.first"), damping, stiffness];
const CONFIG = { published: { impedance: { damping: 6, stiffness: 0 } } };

const draft = (part: Partial<AtlasDraft> = {}): AtlasDraft => ({ x: axisFor(damping.path, PARAMETERS, CONFIG), y: axisFor(stiffness.path, PARAMETERS, CONFIG), requested: "next", futures: "3", staged: false, ...part });

const around = { parameters: PARAMETERS, plan: PLAN, fields: [], phase: "idle" as const, state: null, changes: { published: { first: 2 } } };

describe("what is asked of an atlas", () => {
  it("begins with ranges about the present values, within their bounds", () => {
    expect(axisFor(damping.path, PARAMETERS, CONFIG)).toEqual({ path: damping.path, from: "3", to: "9", count: "11" });
    expect(rangeAbout(damping, 0)).toEqual({ from: "0", to: "1" });
    expect(rangeAbout(parameter("a.mass", { exclusive_minimum: 0, maximum: 1.2 }), 1)).toEqual({ from: "0.5", to: "1.2" });
    expect(rangeAbout(parameter("a.count", { type: "integer" }), 5)).toEqual({ from: "3", to: "8" });
  });

  it("is over the paper's two parameters with its method, else over the first two of the method", () => {
    expect(usualPaths(PARAMETERS, "published")).toEqual([damping.path, stiffness.path]);
    expect(usualPaths([parameter("couple.a"), parameter("couple.b"), parameter("couple.c")], "couple")).toEqual(["couple.a", "couple.b"]);
  });

  it("is of the state as it is, or around what is staged", () => {
    const { request } = readAtlasDraft(draft(), around);
    expect(request).toMatchObject({ source: "live", changes: {}, request: "capture", x: { path: damping.path, from: 3, to: 9, count: 11 }, futures: 3 });
    expect(readAtlasDraft(draft({ staged: true }), around).request?.changes).toEqual(around.changes);
  });

  it("begins in a moment of a stored run that the address names, and goes on with what was under way there", () => {
    const state = stateIn("#/atlas?run=20261125T1-a&at=2.5&phase=caging");
    expect(state).toEqual({ run: "20261125T1-a", at: 2.5, phase: "caging" });
    expect(readAtlasDraft(draft(), { ...around, state }).request).toMatchObject({ source: { run: "20261125T1-a", at: 2.5 }, request: null });
    for (const present of ["#/atlas", "#/atlas/some-id", "#/atlas?at=2", "#/atlas?run=a&at=soon", "#/atlas?run=a&at=-1"]) expect(stateIn(present)).toBeNull();
  });

  it("is refused at the field that is wrong", () => {
    const wrong = draft({ x: { path: "method", from: "1", to: "two", count: "22" }, y: { path: "no.such", from: "", to: "1", count: "1" }, futures: "11" });
    const { request, faults } = readAtlasDraft(wrong, around);
    expect(request).toBeNull();
    expect([...faults.keys()].sort()).toEqual(["futures", "x count", "x path", "x to", "y count", "y from", "y path"]);
    expect(readAtlasDraft(draft({ y: draft().x }), around).faults.get("y path")).toBe("it is the other axis, too");
  });
});

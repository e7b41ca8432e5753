import { describe, expect, it } from "vitest";
import type { Parameter } from "../../api/types";
import { groupsOf } from "./groups";

const METHODS = ["published", "co_moving_couple"];

function parameter(path: string, live: boolean): Parameter {
  const group = path.split(".").slice(0, -1).join(".");
  return { path, group, name: path, title: path, group_title: `Title of ${group}`, description: "", unit: "1", default: 0, source: "", live, type: "number", choice_titles: {} };
}

const PARAMETERS = [
  parameter("published.impedance.mass", true),
  parameter("co_moving_couple.search.gain", true),
  parameter("co_moving_couple.touch.gain", true),
  parameter("target.width", false),
  parameter("control.tracking.gain", true),
  parameter("control.tracking.other", false),
];

const order = (configured: string): string[] => groupsOf(PARAMETERS, METHODS, configured).map(({ group }) => group);

describe("groups of the form", () => {
  it("begin with the configured method and end with the others", () => {
    expect(order("published")).toEqual(["published.impedance", "control.tracking", "target", "co_moving_couple.search", "co_moving_couple.touch"]);
    expect(order("co_moving_couple")).toEqual(["co_moving_couple.search", "co_moving_couple.touch", "control.tracking", "target", "published.impedance"]);
  });

  it("say whose they are where that method is not configured", () => {
    const idle = groupsOf(PARAMETERS, METHODS, "co_moving_couple").filter(({ idleMethod }) => idleMethod !== null);
    expect(idle).toMatchObject([{ group: "published.impedance", idleMethod: "published", begins: true }]);
    expect(groupsOf(PARAMETERS, METHODS, "published").map(({ begins }) => begins)).toEqual([false, false, false, true, false]);
  });

  it("hold all parameters, in the service's order", () => {
    expect(groupsOf(PARAMETERS, METHODS, "published")[1]).toMatchObject({ title: "Title of control.tracking", members: [{ path: "control.tracking.gain" }, { path: "control.tracking.other" }] });
  });
});

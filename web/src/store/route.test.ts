import { describe, expect, it } from "vitest";
import { hashOf, routeOf } from "./route";

describe("the address", () => {
  it("names a page and what it shows", () => {
    expect(routeOf("#/studies/20261125T1-a")).toEqual({ page: "studies", item: "20261125T1-a", other: "" });
    expect(routeOf("#/runs")).toEqual({ page: "runs", item: "", other: "" });
    expect(routeOf("#/runs/a/b")).toEqual({ page: "runs", item: "a", other: "b" });
  });

  it("is the mission when it names nothing known", () => {
    expect(routeOf("")).toEqual({ page: "mission", item: "", other: "" });
    expect(routeOf("#/nowhere/at/all").page).toBe("mission");
  });

  it("may be typed badly", () => {
    for (const bad of ["%", "%E0%A4%A", "%zz", "a%"]) {
      expect(routeOf(`#/runs/${bad}/${bad}`)).toEqual({ page: "runs", item: bad, other: bad });
      expect(routeOf(hashOf(routeOf(`#/runs/${bad}`)))).toEqual(routeOf(`#/runs/${bad}`));
    }
    expect(routeOf("#////%")).toMatchObject({ page: "mission" });
  });

  it("comes back as it was", () => {
    for (const other of ["", "d/e"]) {
      const route = { page: "runs", item: "a b/c", other } as const;
      expect(routeOf(hashOf(route))).toEqual(route);
    }
  });
});

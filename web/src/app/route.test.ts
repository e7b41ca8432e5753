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

  it("comes back as it was", () => {
    for (const other of ["", "d/e"]) {
      const route = { page: "runs", item: "a b/c", other } as const;
      expect(routeOf(hashOf(route))).toEqual(route);
    }
  });
});

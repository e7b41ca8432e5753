import { describe, expect, it } from "vitest";
import { hashOf, routeOf } from "./route";

describe("the address", () => {
  it("names a page and what it shows", () => {
    expect(routeOf("#/studies/20261125T1-a")).toEqual({ page: "studies", item: "20261125T1-a" });
    expect(routeOf("#/runs")).toEqual({ page: "runs", item: "" });
  });

  it("is the mission when it names nothing known", () => {
    expect(routeOf("")).toEqual({ page: "mission", item: "" });
    expect(routeOf("#/nowhere/at/all").page).toBe("mission");
  });

  it("comes back as it was", () => {
    const route = { page: "studies", item: "a b/c" } as const;
    expect(routeOf(hashOf(route))).toEqual(route);
  });
});

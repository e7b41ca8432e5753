import { describe, expect, it } from "vitest";
import { addressOfQuery, isFiltered, DEFAULT_QUERY, queryOf, requestOf, runHash, sortedBy } from "./query";

describe("what the library is asked for", () => {
  it("is kept whole by the address, and nothing is the empty one", () => {
    const query = {
      ...DEFAULT_QUERY,
      text: "damping 3 & more",
      outcome: "base_collision",
      at_first_closure: "caged_force_reduced",
      tag: "figure 7",
      starred: true,
      sort: "peak_tip_force",
      page: 4,
    } as const;
    expect(queryOf(addressOfQuery(query))).toEqual(query);
    expect(addressOfQuery(DEFAULT_QUERY)).toBe("");
    expect(queryOf("")).toEqual(DEFAULT_QUERY);
    expect(runHash(query, "a/b")).toMatch(/^#\/runs\/a%2Fb\?text=damping/);
  });

  it.each(["kind=nothing&sort=-rubbish&page=-3", "page=1e9999&starred=maybe", "%&%%=%E0%A4%A", "sort=-"])("survives %s", (address) => {
    expect(queryOf(address)).toMatchObject({ kind: "", sort: "started", page: 1, starred: false });
  });

  it("is asked of the service page by page", () => {
    expect(requestOf({ ...DEFAULT_QUERY, page: 3, text: "  " })).toEqual({ sort: "-started", limit: 50, offset: 100 });
  });

  it("is ordered the other way round by a second press, from its first page", () => {
    const once = sortedBy({ ...DEFAULT_QUERY, page: 2 }, "peak_tip_force");
    expect(once).toMatchObject({ sort: "peak_tip_force", descending: true, page: 1 });
    expect(sortedBy(once, "peak_tip_force").descending).toBe(false);
    expect(sortedBy(once, "name").descending).toBe(false);
  });

  it("is a filter only if it leaves something out", () => {
    expect(isFiltered({ ...DEFAULT_QUERY, sort: "seed", page: 2 })).toBe(false);
    expect(isFiltered({ ...DEFAULT_QUERY, tag: "x" })).toBe(true);
  });
});

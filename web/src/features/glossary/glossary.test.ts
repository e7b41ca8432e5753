import { describe, expect, it } from "vitest";
import { CLASSES } from "./class-style";
import { meaningOf } from "./glossary";

describe("the glossary", () => {
  it("explains every class of outcome, and the measures that puzzle", () => {
    for (const term of [...CLASSES, "cage_margin", "peak_tip_force_to_closure", "unplanned", "at_first_closure"]) expect(meaningOf(term)).toMatch(/\.$/);
  });

  it("says of what a force is reduced", () => {
    expect(meaningOf("caged_force_reduced")).toMatch(/direct caging/);
  });

  it("is silent about what needs no word", () => {
    expect(meaningOf("duration")).toBeNull();
  });
});

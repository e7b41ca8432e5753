import { describe, expect, it } from "vitest";
import type { Control } from "../../api/types";
import { controlWords, holdOf, reasonAgainst, reasonByControl } from "./control";

const free: Control = { holder: null, since: null, offered_to: null };
const anas: Control = { holder: "ana", since: "2026-11-25T12:00:00.000+00:00", offered_to: null };
const offered: Control = { ...anas, offered_to: "ben" };

describe("who is in control", () => {
  it("is told from where one stands", () => {
    expect([free, anas, offered].map((control) => holdOf(control, "ana"))).toEqual(["free", "mine", "mine"]);
    expect([free, anas, offered].map((control) => holdOf(control, "ben"))).toEqual(["free", "others", "offered"]);
    expect(holdOf(offered, null)).toBe("others");
    expect(controlWords(offered, "ana")).toBe("Offered to ben");
    expect(controlWords(offered, "ben")).toBe("ana hands over to you");
    expect(controlWords(anas, "ben")).toBe("ana is in control");
  });

  it("keeps the commands from everybody else, also from who has an offer and has not taken it", () => {
    expect(reasonByControl(null, "ben")).toBeNull();
    expect(reasonByControl(free, "ben")).toBeNull();
    expect(reasonByControl(anas, "ana")).toBeNull();
    expect(reasonByControl(anas, "ben")).toContain("ana is in control");
    expect(reasonByControl(offered, "ben")).toContain("ana is in control");
  });

  it("comes after the role, which is the lasting reason", () => {
    expect(reasonAgainst({ token_needed: true, name: "vic", role: "viewer" }, anas)).toContain("requires the role operator");
    expect(reasonAgainst({ token_needed: false, name: "operator", role: "admin" }, { ...anas, holder: "operator" })).toBeNull();
  });
});

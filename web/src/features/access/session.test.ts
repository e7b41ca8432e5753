import { describe, expect, it } from "vitest";
import { reasonByRole } from "./session";

describe("what a role may do", () => {
  it("lets everyone do everything where no token is needed", () => {
    expect(reasonByRole({ token_needed: false, name: "operator", role: "admin" }, "admin")).toBeNull();
  });

  it("lets a higher role do what a lower one may", () => {
    expect(reasonByRole({ token_needed: true, name: "ana", role: "admin" }, "operator")).toBeNull();
    expect(reasonByRole({ token_needed: true, name: "ana", role: "operator" }, "operator")).toBeNull();
  });

  it("says which role is missing", () => {
    expect(reasonByRole({ token_needed: true, name: "vic", role: "viewer" }, "operator")).toContain("requires the role operator");
    expect(reasonByRole({ token_needed: true, name: null, role: null }, "viewer")).toContain("not signed in");
  });
});

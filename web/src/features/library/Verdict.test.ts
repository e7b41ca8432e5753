import { expect, test } from "vitest";
import { outcomeWords } from "./Verdict";

test("a sequence before the last one is told by its class and its peak", () => {
  expect(outcomeWords({ outcome: "caged_unplanned_contact", peak_tip_force: 1.899 } as never)).toMatch(/^\S.*, 1\.90 N$/);
});

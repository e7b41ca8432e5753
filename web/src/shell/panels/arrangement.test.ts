import { describe, expect, it } from "vitest";
import { arrangementOf, moved, placeOf, steppedTo, textOf, USUAL } from "./arrangement";

describe("where panels stand", () => {
  it("is kept and shared as a text, with every panel in it once", () => {
    expect(textOf(USUAL)).toBe("commands.parameters_-_outcome.problems.rehearsal.events");
    const other = moved(USUAL, "events", { column: "see", at: 0 });
    expect(arrangementOf(textOf(other))).toEqual(other);
    expect(arrangementOf("")).toEqual(USUAL);
    expect(arrangementOf("events.events.stars_commands_-_more")).toEqual({ act: ["events", "parameters"], see: ["commands"], know: ["outcome", "problems", "rehearsal"] });
  });

  it("is changed by moving one", () => {
    expect(moved(USUAL, "parameters", { column: "know", at: 1 }).know).toEqual(["outcome", "parameters", "problems", "rehearsal", "events"]);
    expect(moved(USUAL, "outcome", { column: "know", at: 2 }).know).toEqual(["problems", "rehearsal", "outcome", "events"]);
    expect(placeOf(USUAL, "rehearsal")).toEqual({ column: "know", at: 2 });
  });

  it("is changed by arrows up to the edges", () => {
    expect(steppedTo(USUAL, "commands", "ArrowLeft")).toBeNull();
    expect(steppedTo(USUAL, "commands", "ArrowUp")).toBeNull();
    expect(steppedTo(USUAL, "commands", "ArrowDown")).toEqual({ column: "act", at: 1 });
    expect(steppedTo(USUAL, "parameters", "ArrowRight")).toEqual({ column: "see", at: 0 });
    expect(steppedTo(USUAL, "events", "Enter")).toBeNull();
    expect(steppedTo(USUAL, "events", "ArrowDown")).toBeNull();
  });
});

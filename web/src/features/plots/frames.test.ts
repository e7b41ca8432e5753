import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Frames } from "./frames";

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("document", { hidden: false });
  vi.stubGlobal("cancelAnimationFrame", () => undefined);
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function counted(): { frames: Frames; drawn: () => number } {
  const frames = new Frames(null);
  let count = 0;
  frames.draw = () => { count += 1; };
  return { frames, drawn: () => count };
}

it("draws once for what is asked while a drawing is due", () => {
  const { frames, drawn } = counted();
  frames.ask(20);
  frames.ask(30);
  vi.advanceTimersByTime(100);
  expect(drawn()).toBe(1);
});

it("draws nothing that was due when it ended", () => {
  const { frames, drawn } = counted();
  frames.ask(20);
  frames.end();
  vi.advanceTimersByTime(100);
  expect(drawn()).toBe(0);
});

it("draws nothing that is asked for after its end, as plots do that come before the next begins", () => {
  const { frames, drawn } = counted();
  frames.end();
  frames.ask(0);
  vi.advanceTimersByTime(100);
  expect(drawn()).toBe(0);
});

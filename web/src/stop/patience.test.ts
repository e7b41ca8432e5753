import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { patience } from "./patience";

describe("patience", () => {
  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("ends after its time, as a time-out", () => {
    const signal = patience(1000);
    vi.advanceTimersByTime(900);
    expect(signal.aborted).toBe(false);
    vi.advanceTimersByTime(200);
    expect(signal.aborted).toBe(true);
    expect((signal.reason as DOMException).name).toBe("TimeoutError");
  });

  it("does not count the time in which the page was held up", () => {
    const signal = patience(1000);
    vi.setSystemTime(Date.now() + 60_000);
    vi.advanceTimersByTime(250);
    expect(signal.aborted).toBe(false);
  });

  it("leaves no timer behind", () => {
    patience(500);
    vi.advanceTimersByTime(1000);
    expect(vi.getTimerCount()).toBe(0);
  });
});

import { describe, expect, it, vi } from "vitest";
import { Player } from "./player";

const player = () => new Player(10, 0.001);

describe("the clock of a replay", () => {
  it("passes at the chosen speed and stops at the end", () => {
    const clock = player();
    clock.choose(2);
    clock.play();
    clock.advance(1500);
    expect(clock.read()).toEqual({ time: 3, playing: true, speed: 2 });
    clock.advance(60_000);
    expect(clock.read()).toEqual({ time: 10, playing: false, speed: 2 });
  });

  it("stands still unless it plays", () => {
    const clock = player();
    clock.advance(1000);
    expect(clock.read().time).toBe(0);
  });

  it("begins anew when played from the end", () => {
    const clock = player();
    clock.seek(10);
    clock.play();
    expect(clock.read()).toMatchObject({ time: 0, playing: true });
  });

  it("steps by whole ticks, within the run, and stands still then", () => {
    const clock = player();
    clock.seek(1.0004);
    clock.play();
    clock.step(1);
    expect(clock.read().time).toBeCloseTo(1.001, 9);
    expect(clock.read().playing).toBe(false);
    clock.step(-5000);
    expect(clock.read().time).toBe(0);
  });

  it("cannot be dragged out of the run, and goes farther in one that grows", () => {
    const clock = player();
    clock.seek(12);
    expect(clock.read().time).toBe(10);
    clock.extend(20);
    clock.seek(12);
    expect(clock.read().time).toBe(12);
  });

  it("opens a second before the first motion, and plays anew from there; what comes before is a drag away", () => {
    const clock = new Player(40, 0.001, 31.2);
    expect(clock.read().time).toBeCloseTo(30.2, 3);
    clock.seek(40);
    clock.play();
    expect(clock.read().time).toBeCloseTo(30.2, 3);
    clock.seek(0);
    expect(clock.read().time).toBe(0);
  });

  it("tells who listens of every change, and of nothing else", () => {
    const clock = player();
    const heard = vi.fn();
    clock.subscribe(heard);
    clock.seek(2);
    clock.seek(2);
    expect(heard).toHaveBeenCalledTimes(1);
  });
});

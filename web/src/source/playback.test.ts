import { describe, expect, it, vi } from "vitest";
import { Playback } from "./playback";

const playbackOf = (end: number, firstMotion = 0): Playback => {
  const playback = new Playback();
  playback.extend({ end, period: 0.001, firstMotion });
  return playback;
};

const player = (): Playback => playbackOf(10);

describe("a playback", () => {
  it("passes at the chosen speed and stops at the end", () => {
    const clock = player();
    clock.setSpeed(2);
    clock.play();
    clock.advance(1500);
    expect(clock.read()).toEqual({ time: 3, playing: true, speed: 2, end: 10 });
    clock.advance(60_000);
    expect(clock.read()).toEqual({ time: 10, playing: false, speed: 2, end: 10 });
  });

  it("stands still unless it plays", () => {
    const clock = player();
    clock.advance(1000);
    expect(clock.read().time).toBe(0);
  });

  it("plays from the start again when it stands at the end", () => {
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
    clock.extend({ end: 20, period: 0.001, firstMotion: 0 });
    clock.seek(12);
    expect(clock.read().time).toBe(12);
  });

  it("opens a second before the first motion, and plays from there again; what comes before is a drag away", () => {
    const clock = playbackOf(40, 31.2);
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

import { describe, expect, it, vi } from "vitest";
import { QUANTITY_NAMES, type QuantityName, type Sample } from "./quantities";
import { Series } from "./series";

const PERIOD = 0.001;

function sample(tick: number, more: Partial<Record<QuantityName, number>> = {}): Sample {
  const zeros = Object.fromEntries(QUANTITY_NAMES.map((name) => [name, 0])) as Record<QuantityName, number>;
  return { ...zeros, tick, time: tick * PERIOD, ...more };
}

const ticks = (series: Series): number[] => [...series.slice("tick", 0, series.length)];

describe("the mission over time", () => {
  it("ignores what it knows already: frames may come after the history that tells of them", () => {
    const series = new Series();
    series.merge([0, 16, 32].map((tick) => sample(tick)));
    for (const tick of [16, 24, 32, 48]) series.append(sample(tick));
    expect(ticks(series)).toEqual([0, 16, 32, 48]);
  });

  it("fills a gap from the history and keeps what came meanwhile", () => {
    const series = new Series();
    for (const tick of [0, 10, 500, 520]) series.append(sample(tick));
    series.merge([100, 200, 500].map((tick) => sample(tick)));
    expect(ticks(series)).toEqual([0, 10, 100, 200, 500, 520]);
  });

  it("stays bounded and keeps the peak force", () => {
    const series = new Series(64);
    for (let tick = 0; tick < 1000; tick += 1) series.append(sample(tick, { rightForce: tick === 77 ? 9 : 1 }));
    expect(series.length).toBeLessThanOrEqual(64);
    expect(Math.max(...series.slice("rightForce", 0, series.length))).toBe(9);
    const kept = ticks(series);
    expect(kept).toEqual([...kept].sort((one, other) => one - other));
    expect(series.lastTick).toBe(999);
  });

  it("finds rows by time", () => {
    const series = new Series();
    for (const tick of [0, 10, 20]) series.append(sample(tick));
    expect(series.rowAt(-1)).toBe(0);
    expect(series.rowAt(0.0101)).toBe(2);
    expect(series.rowAt(9)).toBe(3);
  });

  it("tells the phases with their times", () => {
    const series = new Series();
    for (const [tick, phase] of [[0, 0], [10, 1], [20, 1], [30, 3]] as const) series.append(sample(tick, { phase }));
    expect(series.phaseSpans()).toEqual([
      { phase: "idle", start: 0, end: 0.01 },
      { phase: "detumbling", start: 0.01, end: 0.03 },
      { phase: "holding", start: 0.03, end: 0.03 },
    ]);
    expect(series.firstMotion).toBe(0.01);
  });

  it("begins where it was first recorded, if the mission was on its way", () => {
    const [flying, waiting] = [new Series(), new Series()];
    for (const tick of [50, 60]) flying.append(sample(tick, { phase: 1 }));
    for (const tick of [50, 60]) waiting.append(sample(tick, { phase: 0 }));
    expect(flying.firstMotion).toBe(0.05);
    expect(waiting.firstMotion).toBe(0);
  });

  it("tells of its phases the same whether samples came one by one or were filled in", () => {
    const grown = new Series();
    const told = vi.fn();
    const withdraw = grown.subscribe(told);
    const samples = [0, 0, 1, 1, 2, 1].map((phase, place) => sample(10 * place, { phase }));
    for (const each of samples) grown.append(each);
    expect(told).toHaveBeenCalledTimes(samples.length);
    expect(grown.phaseSpans().map(({ start, end }) => [start, end].map((time) => Math.round(1000 * time)))).toEqual([[0, 20], [20, 40], [40, 50], [50, 50]]);
    const filled = new Series();
    filled.merge(samples);
    expect(filled.phaseSpans()).toEqual(grown.phaseSpans());
    grown.merge([sample(25, { phase: 2 })]);
    expect(grown.phaseSpans()).toHaveLength(6);
    withdraw();
    grown.clear();
    expect(grown.phaseSpans()).toEqual([]);
    expect(told).toHaveBeenCalledTimes(samples.length + 1);
  });
});

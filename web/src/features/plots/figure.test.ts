import { describe, expect, it } from "vitest";
import { figureTable, plotFigure, type PlotFigure } from "./figure";

const FIGURE: PlotFigure = {
  title: "Tip force <resultant>",
  subtitle: "Run 20261122T113000123-4f9a2c",
  yLabel: "Force, N",
  range: { from: 2, to: 6 },
  least: [0, 0.6],
  bands: [{ name: "Left predicted", colour: "#0072b2", times: [2, 4, 8], low: [0, 0.1, 0.2], median: [0.2, 0.3, 0.4], high: [0.4, 1.5, 3] }],
  curves: [{ name: "Left", label: "Left", colour: "#0072b2", width: 1.4, times: [1, 2, 3, 4, 5, 6, 7], values: [9, 0, 1.2, Number.NaN, 0.4, 0, 9] }],
  levels: [{ label: "direct caging", value: 1.13 }],
  phases: [{ phase: "caging", start: 0, end: 8 }],
  touches: [{ arm: "left", start: 2.5, end: null, peak: 1.2, planned: true }],
};

describe("a plot as a figure", () => {
  const markup = plotFigure(FIGURE);

  it("says what it is, of which run, in which units, on white, whatever the page looks like", () => {
    for (const words of ["Tip force &lt;resultant&gt;", "Run 20261122T113000123-4f9a2c", "Force, N", "Mission time, s", "Left", "direct caging", "Caging"]) {
      expect(markup).toContain(words);
    }
    expect(markup).toContain('<rect width="720" height="356" fill="#ffffff"/>');
    expect(markup).not.toMatch(/var\(|class=|currentColor/);
  });

  it("draws nothing where nothing was recorded", () => {
    const path = /<path d="([^"]*)" fill="none" stroke="#0072b2" stroke-width="1.4"/.exec(markup)?.[1] ?? "";
    expect(path.match(/M/g)?.length).toBe(2);
    expect(markup).not.toContain("NaN");
  });

  it("scales its axis by what it shows, not by what lies outside", () => {
    expect(markup).toContain(">1.4<");
    expect(markup).not.toContain(">10<");
    expect(markup).not.toContain(">3<");
  });

  it("has what was predicted behind the curves, and in its table", () => {
    expect(markup.indexOf("<polygon")).toBeGreaterThan(0);
    expect(markup.indexOf("<polygon")).toBeLessThan(markup.indexOf('stroke-width="1.4"'));
    const rows = figureTable(FIGURE).split("\r\n");
    expect(rows).toContain('"Left predicted, 5 %",4,0.1');
    expect(rows).toContain('"Left predicted, median",4,0.3');
    expect(rows).toContain('"Left predicted, 95 %",4,1.5');
    expect(rows.some((row) => row.includes(",8,"))).toBe(false);
  });
});

import { createElement } from "react";
import { renderToStaticMarkup } from "react-dom/server";
import { describe, expect, it } from "vitest";
import type { StudyDetail, StudyRow } from "../../api/types";
import { Figure } from "./figure";
import { usualSpread } from "./layout";

const axis = (path: string, count: number) => ({ path, unit: "N s/m", description: "", count, values: Array.from({ length: count }, (_, place) => place * 1.5), drawn_from: null });
const study = (across: number, up: number): StudyDetail =>
  ({
    id: "20261130T010000000-abcdef",
    name: "two <dampings>",
    axes: [axis("published.impedance.damping", across), axis("published.impedance.stiffness", up)],
    progress: { done: across * up, total: across * up, wall_time: 1 },
    columns: [{ name: "peak_tip_force", kind: "float", unit: "N", description: "" }],
    definition: { configuration: "testbed" },
  }) as unknown as StudyDetail;

function figureOf(across: number, up: number, column: string, alone = false): string {
  const of = study(across, up);
  const varied = (cell: number) => ({ "published.impedance.damping": 1.5 * Math.floor(cell / up), "published.impedance.stiffness": 1.5 * (cell % up) });
  const rows = new Map<number, StudyRow>(Array.from({ length: across * up }, (_, cell) => [cell, { cell, ...varied(cell), outcome: cell % 2 ? "ejection" : "base_collision", peak_tip_force: cell, error: null }]));
  const props = { study: of, rows, spread: usualSpread(of), drawn: [], chosen: new Map<string, number>(), column, published: null, alone };
  return renderToStaticMarkup(createElement(Figure, props));
}

describe("a figure", () => {
  it("stands on white, titled, with a font that every program has", () => {
    const markup = figureOf(3, 2, "outcome");
    expect(markup).toMatch(/^<svg [^>]*width="[\d.]+" height="[\d.]+" font-family="Helvetica, Arial, sans-serif"/);
    expect(markup).toContain('fill="#ffffff"');
    expect(markup).toContain("two &lt;dampings&gt;: outcome");
    expect(markup).toContain("configuration testbed · 6 cells · study 20261130T010000000-abcdef");
    expect(figureOf(3, 2, "peak_tip_force")).toContain("peak tip force [N]");
  });

  it("of each parameter alone has a panel for each, with stacked shares or quantiles in it", () => {
    const classes = figureOf(3, 2, "outcome", true);
    expect(classes).toContain("two &lt;dampings&gt;: outcome");
    expect(classes.match(/role="img"/g)).toHaveLength(2);
    expect(classes.match(/fill="#d55e00" stroke=/g)).toHaveLength(3 + 1 + 1); // at each damping, at one stiffness, in the legend
    expect(classes).toContain("base collision 50 %, ejection 50 %, of 2");
    const numbers = figureOf(3, 2, "peak_tip_force", true);
    expect(numbers).toContain("median 0.5, 5 to 95 %: 0.05 to 0.95, of 2");
    expect(classes + numbers).not.toMatch(/NaN|var\(--|undefined/);
  });

  it("has nothing of the page: no buttons, no ring, no variables of its theme", () => {
    const markup = figureOf(50, 40, "peak_tip_force");
    for (const word of ["button", "tabindex", "cursor", "var(--", "Inter", "linearGradient"]) expect(markup).not.toContain(word);
  });
});

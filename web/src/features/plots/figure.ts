/** One plot as a figure for a paper: markup of an `<svg>` on white that needs nothing of the page. */
import { scaleLinear, type ScaleLinear } from "d3-scale";
import { line } from "d3-shape";
import type { Touch } from "../../api/types";
import { PHASE_WORDS } from "../../source/phases";
import type { PhaseSpan } from "../../source/series";
import { escaped, FIGURE_FONT } from "../../ui/export/figure-file";
import { csvCell } from "../../ui/export/csv";
import { decimalsOf, fixed } from "../../units/units";
import type { Level } from "./plot-set";
import type { Range } from "../../source/source";

export interface FigureCurve {
  /** In a table of its values. */
  readonly name: string;
  /** In the legend; empty where another curve names it, too. */
  readonly label: string;
  readonly colour: string;
  readonly dash?: readonly number[] | undefined;
  readonly width: number;
  readonly times: ArrayLike<number>;
  /** In the unit of the axis; not finite where nothing was recorded. */
  readonly values: ArrayLike<number>;
}

/** What was predicted: between which values 90 % of the futures are, and their median. */
export interface FigureBand {
  /** In a table of its values. */
  readonly name: string;
  readonly colour: string;
  readonly times: readonly number[];
  readonly low: readonly number[];
  readonly median: readonly number[];
  readonly high: readonly number[];
}

export interface PlotFigure {
  readonly title: string;
  /** Which run, and whatever else the reader has to know. */
  readonly subtitle: string;
  /** With its unit, such as "Force, N". */
  readonly yLabel: string;
  readonly range: Range;
  /** What the value axis shows at least. */
  readonly least: readonly [number, number];
  readonly bands: readonly FigureBand[];
  readonly curves: readonly FigureCurve[];
  readonly levels: readonly Level[];
  readonly phases: readonly PhaseSpan[];
  readonly touches: readonly Touch[];
}

export const FIGURE_SIZE = { width: 720, height: 356 } as const;
const EDGE = { left: 64, right: 18, top: 82, bottom: 48 } as const;
const INK = "#1a1a1a";
const FAINT = "#666666";
const GRID = "#e3e3e3";
const SHADES: Readonly<Partial<Record<PhaseSpan["phase"], string>>> = { detumbling: "#eef6fb", caging: "#fdf4e7", holding: "#eef8f1" };

type Scale = ScaleLinear<number, number>;

interface Axes {
  readonly x: Scale;
  readonly y: Scale;
}

const right = FIGURE_SIZE.width - EDGE.right;
const bottom = FIGURE_SIZE.height - EDGE.bottom;

const text = (x: number, y: number, words: string, more = ""): string =>
  `<text x="${fixedPlace(x)}" y="${fixedPlace(y)}" ${more}>${escaped(words)}</text>`;

const rule = (x1: number, y1: number, x2: number, y2: number, stroke: string, more = ""): string =>
  `<line x1="${fixedPlace(x1)}" y1="${fixedPlace(y1)}" x2="${fixedPlace(x2)}" y2="${fixedPlace(y2)}" stroke="${stroke}" ${more}/>`;

const fixedPlace = (value: number): string => String(Math.round(value * 100) / 100);

/** From the least to the largest of what is drawn, with round ends. */
function valueScale(figure: PlotFigure): Scale {
  let [low, high] = figure.least;
  const edges = figure.bands.flatMap(({ times, low: least, high: most }) => [{ times, values: least }, { times, values: most }]);
  for (const { times, values } of [...figure.curves, ...edges]) {
    for (let row = 0; row < times.length; row += 1) {
      const [time, value] = [times[row] ?? Number.NaN, values[row] ?? Number.NaN];
      if (!(time >= figure.range.from && time <= figure.range.to) || !Number.isFinite(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  return scaleLinear().domain([low, high]).range([bottom, EDGE.top]).nice(6);
}

/** Ticks with as many decimals as tell them apart. */
function ticksOf(scale: Scale, count: number): { readonly value: number; readonly label: string }[] {
  const values = scale.ticks(count);
  const decimals = decimalsOf(values);
  return values.map((value) => ({ value, label: fixed(value, decimals) }));
}

function axes({ x, y }: Axes, yLabel: string): string {
  const middle = (EDGE.top + bottom) / 2;
  return [
    ...ticksOf(y, 6).map(({ value, label }) => rule(EDGE.left, y(value), right, y(value), GRID) + text(EDGE.left - 7, y(value) + 4, label, 'text-anchor="end"')),
    ...ticksOf(x, 9).map(({ value, label }) => rule(x(value), bottom, x(value), bottom + 4, INK) + text(x(value), bottom + 17, label, 'text-anchor="middle"')),
    rule(EDGE.left, bottom, right, bottom, INK),
    rule(EDGE.left, EDGE.top, EDGE.left, bottom, INK),
    text((EDGE.left + right) / 2, FIGURE_SIZE.height - 12, "Mission time, s", 'text-anchor="middle"'),
    text(0, 0, yLabel, `text-anchor="middle" transform="translate(16 ${fixedPlace(middle)}) rotate(-90)"`),
  ].join("");
}

/** Each phase in its own shade, with its name above the field, where no curve and no level runs through it. */
function phases({ x }: Axes, { phases: spans, range }: PlotFigure): string {
  return spans
    .map(({ phase, start, end }) => {
      const [from, to] = [x(Math.max(start, range.from)), x(Math.min(end, range.to))];
      if (to <= from) return "";
      const words = PHASE_WORDS[phase];
      const shade = `<rect x="${fixedPlace(from)}" y="${EDGE.top}" width="${fixedPlace(to - from)}" height="${bottom - EDGE.top}" fill="${SHADES[phase] ?? "#ffffff"}"/>`;
      return shade + (to - from > 6.5 * words.length ? text(from + 1, EDGE.top - 5, words, `fill="${FAINT}"`) : "");
    })
    .join("");
}

function curve({ x, y }: Axes, { colour, dash, width, times, values }: FigureCurve, { from, to }: Range): string {
  const rows = Array.from({ length: times.length }, (_, row) => row);
  const time = (row: number): number => times[row] ?? Number.NaN;
  const inView = rows.filter((row) => time(Math.min(row + 1, times.length - 1)) >= from && time(Math.max(row - 1, 0)) <= to);
  const path = line<number>(
    (row) => Math.round(100 * x(time(row))) / 100,
    (row) => Math.round(100 * y(values[row] ?? Number.NaN)) / 100,
  ).defined((row) => Number.isFinite(values[row]))(inView);
  return `<path d="${path ?? ""}" fill="none" stroke="${colour}" stroke-width="${width}" stroke-linejoin="round"${dash ? ` stroke-dasharray="${dash.join(" ")}"` : ""}/>`;
}

/** Behind the curves: filled from edge to edge, the median dashed. */
function band(scales: Axes, { name, colour, times, low, median, high }: FigureBand, range: Range): string {
  const { x, y } = scales;
  const place = (time: number, value: number): string => `${fixedPlace(x(time))},${fixedPlace(y(value))}`;
  const edge = (values: readonly number[]): string[] => times.map((time, row) => place(time, values[row] ?? Number.NaN));
  const fill = `<polygon points="${[...edge(high), ...edge(low).reverse()].join(" ")}" fill="${colour}" fill-opacity="0.16"/>`;
  return fill + curve(scales, { name, label: "", colour, dash: [3, 3], width: 1, times, values: median }, range);
}

/** A level as a dashed line with its name. */
const level = ({ y }: Axes, { label, value }: Level): string => {
  const place = y(value);
  if (place < EDGE.top || place > bottom) return "";
  return rule(EDGE.left, place, right, place, INK, 'stroke-dasharray="2 3"') + text(right - 4, place - 4, label, 'text-anchor="end"');
};

const touch = ({ x }: Axes, { start, end, arm }: Touch, range: Range): string => {
  const [from, to] = [x(Math.max(start, range.from)), x(Math.min(end ?? range.to, range.to))];
  return to < from ? "" : `<rect x="${fixedPlace(from)}" y="${bottom - 4}" width="${fixedPlace(Math.max(1, to - from))}" height="4" fill="${HANDS[arm]}"/>`;
};

/** The colours of the hands on white. */
export const HANDS = { left: "#0072b2", right: "#d55e00" } as const;

function legend(curves: readonly FigureCurve[]): string {
  let place: number = EDGE.left;
  return curves
    .filter(({ label }) => label !== "")
    .map(({ label, colour, dash, width }) => {
      const from = place;
      place += 34 + 6.7 * label.length;
      const sign = rule(from, 51, from + 20, 51, colour, `stroke-width="${Math.max(width, 1.2)}"${dash ? ` stroke-dasharray="${dash.join(" ")}"` : ""}`);
      return sign + text(from + 25, 55, label);
    })
    .join("");
}

/** The values of what is drawn, over the stretch that is shown: a line for each instant, a second recording after the first. */
export function figureTable({ bands, curves, range, yLabel }: Pick<PlotFigure, "bands" | "curves" | "range" | "yLabel">): string {
  const lines = [["curve", "time_s", yLabel]];
  const predicted = bands.flatMap(({ name, times, low, median, high }) => [
    { name: `${name}, 5 %`, times, values: low },
    { name: `${name}, median`, times, values: median },
    { name: `${name}, 95 %`, times, values: high },
  ]);
  for (const { name, times, values } of [...curves, ...predicted]) {
    for (let row = 0; row < times.length; row += 1) {
      const [time, value] = [times[row] ?? Number.NaN, values[row] ?? Number.NaN];
      if (time >= range.from && time <= range.to && Number.isFinite(value)) lines.push([name, String(time), String(value)]);
    }
  }
  return `${lines.map((line) => line.map(csvCell).join(",")).join("\r\n")}\r\n`;
}

export function plotFigure(figure: PlotFigure): string {
  const { width, height } = FIGURE_SIZE;
  const scales: Axes = { x: scaleLinear().domain([figure.range.from, figure.range.to]).range([EDGE.left, right]), y: valueScale(figure) };
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="${FIGURE_FONT}" font-size="12" fill="${INK}">`,
    `<rect width="${width}" height="${height}" fill="#ffffff"/>`,
    `<clipPath id="field"><rect x="${EDGE.left}" y="${EDGE.top}" width="${right - EDGE.left}" height="${bottom - EDGE.top}"/></clipPath>`,
    text(EDGE.left, 20, figure.title, 'font-size="15" font-weight="bold"'),
    text(EDGE.left, 37, figure.subtitle, `font-size="11" fill="${FAINT}"`),
    phases(scales, figure),
    axes(scales, figure.yLabel),
    `<g clip-path="url(#field)">`,
    ...figure.bands.map((each) => band(scales, each, figure.range)),
    ...figure.curves.map((each) => curve(scales, each, figure.range)),
    ...figure.touches.map((each) => touch(scales, each, figure.range)),
    "</g>",
    ...figure.levels.map((each) => level(scales, each)),
    legend(figure.curves),
    "</svg>",
  ].join("\n");
}

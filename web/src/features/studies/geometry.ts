/** Where everything of a map stands, in the units of its picture: the letters keep their size however many cells there are. */
import { shown as shownUnit } from "../../units/units";
import type { GridAxis, Spread, Value } from "./layout";
import { fitting, textWidth, ticksOf, type Tick } from "./ticks";

export const LABEL_SIZE = 10.5;
export const TITLE_SIZE = 11;
/** Cells below this are too small for the letter of their class. */
export const LETTERED_CELL = 12;

const LARGEST_CELL = 64;
const SMALLEST_CELL = 1.5;
const TOP = 28;
const GAP = 18;
const LEGEND_LINE = 20;
/** Left and right of a legend, together. */
export const LEGEND_MARGIN = 80;
/** Between a label and the cells, and between labels that stand beside each other. */
const PAD = 6;

export interface Frame {
  readonly width: number;
  readonly height: number;
}

/** One axis as it is drawn. */
export interface AxisPicture {
  readonly ticks: readonly Tick[];
  readonly title: string;
}

export interface Geometry {
  /** Panels beside each other. */
  readonly across: number;
  /** Height of a cell. */
  readonly cell: number;
  /** Its width: the same, but for names, which are long. */
  readonly wide: number;
  /** Of a panel's cells, from the panel's own corner. */
  readonly left: number;
  readonly top: number;
  readonly panel: Frame;
  readonly size: Frame;
  readonly x: AxisPicture;
  readonly y: AxisPicture | null;
  readonly head: number;
}

const unitOf = (unit: string): string => shownUnit(unit, "rad").unit;

/** The end of its path, by which a person knows a parameter. */
export const axisName = (path: string): string => path.split(".").slice(-2).join(" ").replaceAll("_", " ");

const withUnit = (name: string, unit: string): string => (unitOf(unit) === "" ? name : `${name} [${unitOf(unit)}]`);

export const axisTitle = (axis: { readonly path: string; readonly unit: string }): string => withUnit(axisName(axis.path), axis.unit);

/** The same in ever fewer words. */
const titlesOf = (axis: GridAxis): string[] => {
  const last = (axis.path.split(".").at(-1) ?? "").replaceAll("_", " ");
  return [axisTitle(axis), withUnit(last, axis.unit), last];
};

const beside = (text: string): number => textWidth(text, LABEL_SIZE) + PAD;
const longestName = (values: readonly Value[]): number => Math.max(...values.map((value) => (typeof value === "string" ? beside(value) : 0)));
const below = (): number => LABEL_SIZE + 3;

interface Wanted {
  readonly spread: Spread;
  /** Whether the published panels stand under ours. */
  readonly compared: boolean;
  readonly frame: Frame;
  readonly legendLines: number;
  /** Room above all panels, for a title. */
  readonly head: number;
}

/** The picture with so many panels beside each other; cells as large as the frame allows. */
function pictureOf({ spread, compared, frame, legendLines, head }: Wanted, across: number): Geometry {
  const [columns, lines] = [spread.x.values.length, spread.y?.values.length ?? 1];
  const panels = spread.facet?.values.length ?? 1;
  const storeys = Math.ceil(panels / across) * (compared ? 2 : 1);
  const legend = 16 + legendLines * LEGEND_LINE;
  // The labels of all values are wider than those that are left: the margin is safe, and does not hang on the cells.
  const labels = spread.y === null ? 0 : Math.max(...ticksOf(spread.y.values, LARGEST_CELL, below).map(({ text }) => textWidth(text, LABEL_SIZE)), 12);
  const left = spread.y === null ? 16 : TITLE_SIZE + 2 * PAD + labels + PAD;
  const bottom = PAD + LABEL_SIZE + PAD + TITLE_SIZE + 2 * PAD;
  const roomAcross = (frame.width / across - left - GAP) / columns;
  const room = Math.min(roomAcross, ((frame.height - legend - head) / storeys - TOP - bottom) / lines);
  const square = Math.min(LARGEST_CELL, Math.max(SMALLEST_CELL, room >= 8 ? Math.floor(room) : room));
  const cell = spread.y === null ? LARGEST_CELL : square;
  const wide = Math.max(square, Math.min(roomAcross, longestName(spread.x.values)));
  // Narrow panels leave room for their titles.
  const width = Math.max(left + columns * wide + GAP, left + 130);
  const panel = { width, height: TOP + lines * cell + bottom };
  const x = { ticks: ticksOf(spread.x.values, wide, beside), title: fitting(titlesOf(spread.x), width - left, TITLE_SIZE) };
  const y = spread.y && { ticks: ticksOf(spread.y.values, cell, below), title: fitting(titlesOf(spread.y), lines * cell + TOP + bottom - 20, TITLE_SIZE) };
  const size = { width: Math.max(across * width, 420), height: head + storeys * panel.height + legend };
  return { across, cell, wide, left, top: TOP, panel, size, x, y, head };
}

/** Panels beside each other as makes their cells largest. */
export function geometryOf(wanted: Wanted): Geometry {
  const panels = wanted.spread.facet?.values.length ?? 1;
  const pictures = Array.from({ length: panels }, (_, more) => pictureOf(wanted, more + 1));
  const scale = ({ size }: Geometry): number => Math.min(1, wanted.frame.width / size.width, wanted.frame.height / size.height);
  return pictures.reduce((best, each) => (each.wide * scale(each) > best.wide * scale(best) + 1e-9 ? each : best));
}

const LEGEND_PASSES = 3;

/** The picture with as many lines for its legend as those words take below it: a narrow picture needs more. */
export function geometryWith(legend: readonly string[], wanted: Omit<Wanted, "legendLines">): Geometry {
  const linesIn = ({ size }: Geometry): number => legendPlaces(legend, size.width - LEGEND_MARGIN).reduce((most, { line }) => Math.max(most, line + 1), 2);
  let lines = 2;
  let geometry = geometryOf({ ...wanted, legendLines: lines });
  // More lines leave less room for cells, which may make the picture narrower still.
  for (let pass = 0; pass < LEGEND_PASSES && linesIn(geometry) > lines; pass += 1) {
    lines = linesIn(geometry);
    geometry = geometryOf({ ...wanted, legendLines: lines });
  }
  return geometry;
}

/** Entries of a legend in lines that fit that width: each with its place. */
export function legendPlaces(words: readonly string[], width: number): { readonly x: number; readonly line: number }[] {
  let [x, line] = [0, 0];
  return words.map((text) => {
    const needed = 34 + textWidth(text, TITLE_SIZE);
    if (x > 0 && x + needed > width) [x, line] = [0, line + 1];
    const place = { x, line };
    x += needed;
    return place;
  });
}

export const LEGEND_STEP = LEGEND_LINE;

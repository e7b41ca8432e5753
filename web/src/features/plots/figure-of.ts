/** What a plot shows now, as a figure: the same curves over the same stretch, in colours for white paper. */
import type { Shown } from "../../units/units";
import { comparedSlice } from "./compared";
import { figureTable, HANDS, plotFigure, type FigureBand, type FigureCurve, type PlotFigure } from "./figure";
import type { PlotFrame } from "./Plot";
import type { Curve, PlotDefinition } from "./plot-set";
import type { Placed } from "./prediction";

/** Where the curves come from. */
export interface FigureSource {
  /** Such as "Run 20261122T113000123-4f9a2c". */
  readonly words: string;
  /** Of the run that it is compared with; null for none. */
  readonly other: string | null;
  /** The beginning of a file's name. */
  readonly file: string;
}

/** Okabe and Ito's colours that stand out on white, by the tokens of the page. */
const COLOURS: Readonly<Record<string, string>> = { ...HANDS, target: "#009e73", base: "#7a4f9a" };

const colourOf = ({ token }: Curve): string => COLOURS[token] ?? "#1a1a1a";

const WIDTHS = { own: 1.5, compared: 0.9 } as const;

type Given = readonly [definition: PlotDefinition, scale: Shown, frame: PlotFrame | null, source: FigureSource];

/** Markup of an `<svg>`. @throws Error if nothing has been drawn yet. */
export const markupOf = (...given: Given): string => plotFigure(figureOf(...given));

/** Its values with commas. @throws Error if nothing has been drawn yet. */
export const tableOf = (...given: Given): string => figureTable(figureOf(...given));

function figureOf(...[definition, scale, frame, source]: Given): PlotFigure {
  if (frame === null || frame.series.length === 0) throw new Error("There is nothing to export yet.");
  const { series, compared, predicted, range, decorations } = frame;
  const scaled = (values: Float64Array): Float64Array => values.map((value) => value * scale.factor);
  const quantities = definition.curves.map(({ quantity }) => quantity);
  const [from, to] = [Math.max(0, series.rowAt(range.from) - 1), Math.min(series.length, series.rowAt(range.to) + 1)];
  const own = definition.curves.map((curve, index): FigureCurve => ({
    name: nameOf(definition.curves, index),
    label: nameOf(definition.curves, index),
    colour: colourOf(curve),
    dash: curve.dash,
    width: WIDTHS.own,
    times: series.slice("time", from, to),
    values: scaled(series.slice(curve.quantity, from, to)),
  }));
  const [times, others] = compared === null ? [new Float64Array(), []] : comparedSlice(compared, range, quantities);
  const theirs = others.map((values, index): FigureCurve => {
    const curve = definition.curves[index];
    if (curve === undefined) throw new Error("A curve without a definition.");
    return { name: `other run, ${nameOf(definition.curves, index)}`, label: "", colour: colourOf(curve), dash: curve.dash, width: WIDTHS.compared, times, values: scaled(values) };
  });
  const bands = predicted === null ? [] : bandsWithin(definition.curves, predicted, scale.factor);
  // Named once: a name for each curve of both would not fit beside one another.
  const sign: FigureCurve = { name: "", label: "other run, thinner", colour: "#666666", width: WIDTHS.compared, times: [], values: [] };
  return {
    title: definition.title,
    subtitle: [source.words, ...(source.other === null ? [] : [`other run ${source.other}`]), ...(bands.length === 0 ? [] : ["shaded and dashed: predicted, 5 to 95 % and median"])].join("; "),
    yLabel: `${definition.axis}${scale.unit === "" ? "" : `, ${scale.unit}`}`,
    range,
    least: [definition.least[0] * scale.factor, definition.least[1] * scale.factor],
    bands,
    curves: [...own, ...theirs, ...(compared === null ? [] : [sign])],
    levels: definition.levels(frame.known).map(({ label: words, value }) => ({ label: words, value: value * scale.factor })),
    phases: decorations.phases,
    touches: decorations.touches,
  };
}

/** The predicted bands of these curves, where they are drawn. */
function bandsWithin(curves: readonly Curve[], { prediction, shift }: Placed, factor: number): FigureBand[] {
  const scaled = (values: readonly number[]): number[] => values.map((value) => value * factor);
  return curves.flatMap((curve, index): FigureBand[] => {
    const band = prediction.bands.get(curve.quantity);
    if (band === undefined) return [];
    const { times, low, median, high } = band;
    return [{ name: `${nameOf(curves, index)} predicted`, colour: colourOf(curve), times: times.map((time) => time + shift), low: scaled(low), median: scaled(median), high: scaled(high) }];
  });
}

/** A curve without a label is the commanded one of the curve before it. */
function nameOf(curves: readonly Curve[], index: number): string {
  const own = curves[index]?.label ?? "";
  return own === "" ? `${curves[index - 1]?.label ?? ""} commanded` : own;
}

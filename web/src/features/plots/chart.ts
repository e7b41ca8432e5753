/** One uPlot chart over the mission's series; knows nothing of React. */
import uPlot from "uplot";
import type { Touch } from "../../api/types";
import type { Series } from "../../source/series";
import type { CanvasColours } from "../../ui/theme/canvas";
import { decimalsOf, fixed, type Shown } from "../../units/units";
import { drawLevels, drawMoment, drawPeaks, drawPhases, drawTouches, type Decorations } from "./decorations";
import { comparedSlice, type Compared } from "./compared";
import { drawPrediction } from "./fan";
import { instantOfPeak } from "./peaks";
import type { PlotDefinition } from "./plot-set";
import { extentOf, type Placed } from "./prediction";
import { scaledCurve } from "./scaled-curve";
import { timeLabels } from "./timeview";
import type { Range } from "../../source/source";

const CURSORS = uPlot.sync("becalm-time");
const AXIS_WIDTH = 52;
const AXIS_HEIGHT = 22;
const WHEEL_STEP = 1.25;

/** What is drawn of the mission. */
export interface ChartContent {
  readonly series: Series;
  readonly range: Range;
  readonly compared: Compared | null;
  readonly predicted: Placed | null;
}

export interface ChartEvents {
  /** A stretch was drawn with the mouse, between two times. */
  readonly select: (one: number, other: number) => void;
  /** Double click: back to following. */
  readonly follow: () => void;
  /** The wheel was turned at a moment; a factor above 1 shows more. */
  readonly wheel: (moment: number, factor: number) => void;
  /** A moment was clicked. */
  readonly moment: (time: number) => void;
  /** The cursor has moved. */
  readonly cursor: () => void;
}

export class Chart {
  private readonly plot: uPlot;
  private decorations: Decorations | null = null;
  private predicted: Placed | null = null;
  /** What is predicted within view, in the unit of the axis. */
  private predictedRange: readonly [number, number] = [Infinity, -Infinity];
  /** The highest peak that is marked in view. */
  private peak = -Infinity;
  private peakInstants: readonly number[] = [];

  constructor(
    private readonly definition: PlotDefinition,
    private readonly shown: Shown,
    colours: CanvasColours,
    place: HTMLElement,
    events: ChartEvents,
    private readonly timed: boolean,
    private readonly comparing: boolean,
  ) {
    const empty = [[], ...this.series(colours).slice(1).map(() => [])] as unknown as uPlot.AlignedData;
    this.plot = new uPlot(this.options(colours, place, events), empty, place);
    this.plot.over.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const moment = this.plot.posToVal(event.offsetX, "x");
        events.wheel(moment, event.deltaY > 0 ? WHEEL_STEP : 1 / WHEEL_STEP);
      },
      { passive: false },
    );
  }

  resize(place: HTMLElement): void {
    this.plot.setSize({ width: place.clientWidth, height: place.clientHeight });
  }

  draw({ series, range, compared, predicted }: ChartContent, decorations: Decorations): void {
    const from = Math.max(0, series.rowAt(range.from) - 1);
    const to = Math.min(series.length, series.rowAt(range.to) + 1);
    this.decorations = decorations;
    this.predicted = predicted;
    this.predictedRange = this.predictedWithin(range);
    this.peakInstants = this.definition.peaks ? decorations.touches.map((touch) => instantOfPeak(series, touch)) : [];
    this.peak = this.definition.peaks ? highestPeak(decorations.touches, range) : -Infinity;
    const quantities = this.definition.curves.map(({ quantity }) => quantity);
    const own = this.table(series.slice("time", from, to), quantities.map((quantity) => series.slice(quantity, from, to)));
    const data = compared === null ? own : uPlot.join([own, this.table(...comparedSlice(compared, range, quantities))]);
    this.plot.batch(() => {
      this.plot.setData(data, false);
      this.plot.setScale("x", { min: range.from, max: range.to });
    });
  }

  /** The time under the cursor, which stays where it is while the data pass beneath it. */
  get cursorTime(): number | null {
    const left = this.plot.cursor.left ?? -1;
    return left < 0 ? null : this.plot.posToVal(left, "x");
  }

  /** Moves the cursor by that part of the width; from the newest value where there was none. */
  moveCursor(share: number): void {
    const { width, height } = this.plot.over.getBoundingClientRect();
    const before = this.plot.cursor.left ?? -1;
    const left = Math.min(width - 1, Math.max(0, (before < 0 ? width : before) + share * width));
    this.plot.setCursor({ left, top: height / 2 });
  }

  hideCursor(): void {
    this.plot.setCursor({ left: -10, top: -10 });
  }

  destroy(): void {
    this.plot.destroy();
  }

  private table(times: Float64Array, curves: readonly Float64Array[]): uPlot.AlignedData {
    return [times, ...curves.map((curve) => scaledCurve(curve, this.shown.factor))] as uPlot.AlignedData;
  }

  private options(colours: CanvasColours, place: HTMLElement, events: ChartEvents): uPlot.Options {
    return {
      width: place.clientWidth,
      height: place.clientHeight,
      padding: [6, 20, 0, 0],
      legend: { show: false },
      cursor: {
        sync: { key: CURSORS.key, setSeries: false, scales: ["x", null] },
        drag: { x: true, y: false, setScale: false },
        y: false,
        points: { size: 5 },
      },
      scales: { x: { time: false }, y: { range: (_, low, high) => this.yRange(low, high) } },
      axes: [this.timeAxis(colours), { ...axis(colours), size: AXIS_WIDTH }],
      series: this.series(colours),
      hooks: {
        drawClear: [
          (plot) => {
            if (this.decorations === null) return;
            drawPhases(plot, this.decorations);
            if (this.predicted) drawPrediction(plot, this.predicted, this.definition.curves, this.shown.factor, this.decorations.colours);
          },
        ],
        draw: [
          (plot) => {
            if (this.decorations === null) return;
            drawLevels(plot, this.decorations);
            drawTouches(plot, this.decorations);
            if (this.definition.peaks) drawPeaks(plot, this.decorations, this.peakInstants);
            drawMoment(plot, this.decorations);
          },
        ],
        setCursor: [
          () => {
            events.cursor();
          },
        ],
        setSelect: [
          (plot) => {
            this.selected(plot, events);
          },
        ],
        ready: [
          (plot) => {
            plot.over.addEventListener("dblclick", events.follow);
            // The click at the end of a drag is held back by uPlot itself.
            plot.over.addEventListener("click", (event) => {
              events.moment(plot.posToVal(event.offsetX, "x"));
            });
          },
        ],
      },
    };
  }

  /** Time, the curves, and those of a second recording: thinner and paler. */
  private series(colours: CanvasColours): uPlot.Series[] {
    const curves = this.definition.curves.map((curve) => curveOptions(curve.token, curve.dash, colours));
    const others = this.comparing ? curves.map((curve) => ({ ...curve, width: 1, alpha: 0.6 })) : [];
    return [{}, ...curves, ...others];
  }

  private selected(plot: uPlot, events: ChartEvents): void {
    const { left, width } = plot.select;
    if (width < 4) return;
    events.select(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  /** As wide as the data, at least as wide as the definition says, with some air. */
  private yRange(low: number | null, high: number | null): [number, number] {
    const [least, most] = this.definition.least.map((value) => value * this.shown.factor) as [number, number];
    const [lowest, highest] = this.predictedRange;
    const bottom = Math.min(low ?? least, least, lowest);
    const top = Math.max(high ?? most, most, this.peak, highest);
    const span = top - bottom;
    // The names of the phases stand in the air above the curves.
    return [bottom === 0 ? 0 : bottom - 0.08 * span, top + 0.22 * span];
  }

  private predictedWithin({ from, to }: Range): readonly [number, number] {
    const placed = this.predicted;
    if (placed === null) return [Infinity, -Infinity];
    const extents = this.definition.curves.flatMap(({ quantity }) => {
      const band = placed.prediction.bands.get(quantity);
      return (band && extentOf(band, placed.shift, from, to)) ?? [];
    });
    const values = extents.map((value) => value * this.shown.factor);
    return [Math.min(Infinity, ...values), Math.max(-Infinity, ...values)];
  }

  /** Of plots that stand above one another only the lowest names the times. */
  private timeAxis(colours: CanvasColours): uPlot.Axis {
    return this.timed ? { ...axis(colours), size: AXIS_HEIGHT, values: (_, splits) => timeLabels(splits) } : { ...axis(colours), size: 8, values: () => [] };
  }
}

export const axis = (colours: CanvasColours): uPlot.Axis => ({
  gap: 4,
  stroke: colours.faint,
  font: "11px Inter, sans-serif",
  grid: { stroke: colours.grid, width: 1 },
  ticks: { show: false },
  values: (_, splits) => splits.map((value) => fixed(value, decimalsOf(splits))),
});

function highestPeak(touches: readonly Touch[], range: Range): number {
  const inView = touches.filter((touch) => touch.start <= range.to && (touch.end ?? range.to) >= range.from);
  return Math.max(-Infinity, ...inView.map((touch) => touch.peak));
}

function curveOptions(token: string, dash: readonly number[] | undefined, colours: CanvasColours): uPlot.Series {
  const stroke = colours.of(token);
  return { stroke, width: 1.6, ...(dash && { dash: [...dash] }), points: { show: false } };
}

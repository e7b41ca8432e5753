/** Round trips and command ages of the last minute in one uPlot chart; knows nothing of React. */
import uPlot from "uplot";
import type { LinkStatus } from "../../api/types";
import type { CanvasColours } from "../../ui/theme/canvas";
import { axis } from "../plots/chart";
import { drawLevels } from "../plots/decorations";

const SPAN = 60;
/** Milliseconds that are always in view: what is usual, and the deadline. Logarithmic, so that both can be read. */
const LEAST = 0.1;
const MOST = 200;
// eslint-disable-next-line @typescript-eslint/no-unsafe-enum-assignment -- no name of it: an ambient const enum
const LOGARITHMIC = 3 as uPlot.Scale.Distr;

export const CURVES = [
  { key: "round_trip", token: "left", dash: undefined, label: "Round trip" },
  { key: "command_age", token: "right", dash: [6, 3], label: "Command age" },
] as const;

export class LatencyChart {
  private readonly plot: uPlot;
  private deadline: number | null = null;

  constructor(place: HTMLElement, colours: CanvasColours) {
    this.plot = new uPlot(
      {
        width: place.clientWidth,
        height: place.clientHeight,
        padding: [8, 14, 0, 0],
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false }, points: { size: 5 } },
        scales: {
          x: { time: false, range: [-SPAN, 0] },
          y: { distr: LOGARITHMIC, range: (_, __, high) => [LEAST, 1.5 * Math.max(MOST, high)] },
        },
        axes: [
          { ...axis(colours), size: 26 },
          { ...axis(colours), size: 46, values: (_, splits) => splits.map((value) => (isDecade(value) ? String(value) : "")) },
        ],
        series: [{}, ...CURVES.map(({ token, dash }) => ({ stroke: colours.of(token), width: 1.5, ...(dash && { dash: [...dash] }), points: { show: false } }))],
        hooks: {
          draw: [
            (plot) => {
              if (this.deadline !== null) drawLevels(plot, { levels: [{ label: "deadline", value: 1000 * this.deadline }], colours });
            },
          ],
        },
      },
      [[], [], []],
      place,
    );
  }

  draw({ latency, deadline }: LinkStatus): void {
    this.deadline = deadline;
    const milliseconds = (value: number | null): number | null => (value === null ? null : Math.max(LEAST, 1000 * value));
    this.plot.setData([
      latency.map(({ ago }) => -ago),
      ...CURVES.map(({ key }) => latency.map((point) => milliseconds(point[key]))),
    ] as uPlot.AlignedData);
  }

  resize(place: HTMLElement): void {
    this.plot.setSize({ width: place.clientWidth, height: place.clientHeight });
  }

  destroy(): void {
    this.plot.destroy();
  }
}

const isDecade = (value: number): boolean => Number.isInteger(Number(Math.log10(value).toFixed(6)));

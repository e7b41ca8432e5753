/** Round trips and command ages of the last minute in one uPlot chart; knows nothing of React. */
import uPlot from "uplot";
import type { LinkStatus } from "../../api/types";
import type { CanvasColours } from "../../theme/canvas";
import { axis } from "../plots/chart";

const SPAN = 60;
/** Milliseconds that are always in view. */
const LEAST = 5;

export const CURVES = [
  { key: "round_trip", token: "left", dash: undefined, label: "Round trip" },
  { key: "command_age", token: "right", dash: [6, 3], label: "Command age" },
] as const;

export class LatencyChart {
  private readonly plot: uPlot;

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
          y: { range: (_, __, high) => [0, 1.15 * Math.max(LEAST, high)] },
        },
        axes: [
          { ...axis(colours), size: 26 },
          { ...axis(colours), size: 46 },
        ],
        series: [{}, ...CURVES.map(({ token, dash }) => ({ stroke: colours.of(token), width: 1.5, ...(dash && { dash: [...dash] }), points: { show: false } }))],
      },
      [[], [], []],
      place,
    );
  }

  draw(latency: LinkStatus["latency"]): void {
    const milliseconds = (value: number | null): number | null => (value === null ? null : 1000 * value);
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

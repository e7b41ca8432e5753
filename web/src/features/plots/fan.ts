/** Behind the curves: the predicted bands, 5 to 95 % filled and the median dashed, each in the colour of its quantity. */
import type uPlot from "uplot";
import type { CanvasColours } from "../../ui/theme/canvas";
import type { Curve } from "./plot-set";
import type { Placed, PredictedBand } from "./prediction";

const FILL = 0.16;
const MEDIAN = 0.8;
const DASH = [3, 3];

/** @param factor from SI to the unit of the axis */
export function drawPrediction(plot: uPlot, { prediction, shift }: Placed, curves: readonly Curve[], factor: number, colours: CanvasColours): void {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const { quantity, token } of curves) {
    const band = prediction.bands.get(quantity);
    if (band) drawBand(plot, band, shift, factor, colours.of(token));
  }
  ctx.restore();
}

function drawBand(plot: uPlot, { times, low, median, high }: PredictedBand, shift: number, factor: number, colour: string): void {
  const { ctx } = plot;
  const ratio = plot.bbox.width / Math.max(1, plot.over.clientWidth);
  const across = times.map((time) => plot.valToPos(time + shift, "x", true));
  const along = (values: readonly number[], backwards = false): void => {
    for (let step = 0; step < across.length; step += 1) {
      const place = backwards ? across.length - 1 - step : step;
      ctx.lineTo(across[place] ?? 0, plot.valToPos((values[place] ?? 0) * factor, "y", true));
    }
  };
  ctx.fillStyle = ctx.strokeStyle = colour;
  ctx.globalAlpha = FILL;
  ctx.beginPath();
  along(high);
  along(low, true);
  ctx.fill();
  ctx.globalAlpha = MEDIAN;
  ctx.lineWidth = ratio;
  ctx.setLineDash(DASH.map((part) => part * ratio));
  ctx.beginPath();
  along(median);
  ctx.stroke();
  ctx.setLineDash([]);
}

/** What a plot draws besides its curves: phases behind, touches and levels in front. */
import uPlot from "uplot";
import type { Touch } from "../../api/types";
import type { Phase } from "../../source/phases";
import type { PhaseSpan } from "../../source/series";
import type { CanvasColours } from "../../ui/theme/canvas";
import { PHASE_WORDS } from "../../source/phases";
import type { Level } from "./plot-set";

const SHADES: Readonly<Partial<Record<Phase, string>>> = {
  detumbling: "shade-detumbling",
  caging: "shade-caging",
  holding: "shade-holding",
  stopped: "shade-off",
  faulted: "shade-off",
};

export interface Decorations {
  readonly phases: readonly PhaseSpan[];
  readonly touches: readonly Touch[];
  /** In the unit of the plot's axis. */
  readonly levels: readonly Level[];
  readonly colours: CanvasColours;
  /** The moment that a replay shows; null without one. */
  readonly moment: number | null;
}

const FONT = "11px Inter, sans-serif";

const scaled = (font: string): string => font.replace("11px", `${11 * uPlot.pxRatio}px`);

/** Behind the curves: each phase in its own shade, with its name where there is room. */
export function drawPhases(plot: uPlot, { phases, colours }: Decorations): void {
  const { ctx, bbox } = plot;
  const ratio = uPlot.pxRatio;
  ctx.save();
  ctx.font = scaled(FONT);
  ctx.textAlign = "left";
  ctx.textBaseline = "top";
  for (const { phase, start, end } of phases) {
    const left = Math.max(bbox.left, plot.valToPos(start, "x", true));
    const right = Math.min(bbox.left + bbox.width, plot.valToPos(end, "x", true));
    if (right <= left) continue;
    const shade = SHADES[phase];
    ctx.fillStyle = shade === undefined ? "transparent" : colours.of(shade);
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    ctx.fillStyle = colours.line;
    ctx.fillRect(left, bbox.top, ratio, bbox.height);
    const words = PHASE_WORDS[phase];
    ctx.fillStyle = colours.faint;
    if (ctx.measureText(words).width + 10 * ratio < right - left) ctx.fillText(words, left + 5 * ratio, bbox.top + 4 * ratio);
  }
  ctx.restore();
}

/** In front: levels as dashed lines with their names. */
export function drawLevels(plot: uPlot, { levels, colours }: Pick<Decorations, "levels" | "colours">): void {
  const { ctx, bbox } = plot;
  const ratio = uPlot.pxRatio;
  ctx.save();
  ctx.font = scaled(FONT);
  ctx.textAlign = "right";
  ctx.textBaseline = "bottom";
  ctx.lineWidth = ratio;
  ctx.setLineDash([2 * ratio, 4 * ratio]);
  for (const { label, value } of levels) {
    const y = Math.round(plot.valToPos(value, "y", true));
    if (y < bbox.top || y > bbox.top + bbox.height) continue;
    ctx.strokeStyle = colours.text;
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.fillStyle = colours.text;
    ctx.fillText(label, bbox.left + bbox.width - 6 * ratio, y - 2 * ratio);
  }
  ctx.restore();
}

/** In front: the peak that was measured tick by tick within each touch, at its instant. */
export function drawPeaks(plot: uPlot, { touches, colours }: Decorations, instants: readonly number[]): void {
  const { ctx, bbox } = plot;
  const size = 4 * uPlot.pxRatio;
  ctx.save();
  ctx.lineWidth = 1.5 * uPlot.pxRatio;
  for (const [place, touch] of touches.entries()) {
    const x = plot.valToPos(instants[place] ?? touch.start, "x", true);
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    const y = plot.valToPos(touch.peak, "y", true);
    ctx.strokeStyle = colours.of(touch.arm);
    ctx.fillStyle = colours.panel;
    ctx.beginPath();
    ctx.moveTo(x, y - size);
    ctx.lineTo(x + size, y);
    ctx.lineTo(x, y + size);
    ctx.lineTo(x - size, y);
    ctx.closePath();
    ctx.fill();
    ctx.stroke();
  }
  ctx.restore();
}

/** Where a label would stand, and whether it says more than the others. */
interface Label {
  readonly left: number;
  readonly width: number;
  readonly matters: boolean;
}

/** Which labels of a row there is room for, side by side: first those that matter, then the others, from the left. */
export function readable(labels: readonly Label[], gap: number): boolean[] {
  const taken: Label[] = [];
  const clear = (one: Label): boolean => taken.every((other) => one.left >= other.left + other.width + gap || other.left >= one.left + one.width + gap);
  const shown = labels.map(() => false);
  for (const matters of [true, false]) {
    for (const [place, label] of labels.entries()) {
      if (label.matters !== matters || !clear(label)) continue;
      taken.push(label);
      shown[place] = true;
    }
  }
  return shown;
}

const touchWords = ({ arm, planned }: Touch): string => `${arm === "left" ? "L" : "R"}${planned ? "" : "!"}`;

/** In front: each touch as a bar along the bottom; where there is room with the letter of its hand, an unplanned one with an exclamation mark. */
export function drawTouches(plot: uPlot, { touches, colours }: Decorations): void {
  const { ctx, bbox } = plot;
  const ratio = uPlot.pxRatio;
  const bottom = bbox.top + bbox.height;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.font = `600 ${scaled(FONT)}`;
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  const labels = touches.map((touch) => ({
    left: plot.valToPos(touch.start, "x", true) + 4 * ratio,
    width: ctx.measureText(touchWords(touch)).width,
    matters: !touch.planned,
  }));
  const shown = readable(labels, 4 * ratio);
  for (const [place, touch] of touches.entries()) {
    const left = plot.valToPos(touch.start, "x", true);
    const right = plot.valToPos(touch.end ?? plot.data[0].at(-1) ?? touch.start, "x", true);
    ctx.fillStyle = colours.of(touch.arm);
    ctx.fillRect(left, bottom - 4 * ratio, Math.max(2 * ratio, right - left), 4 * ratio);
    ctx.globalAlpha = 0.45;
    ctx.fillRect(left, bbox.top, ratio, bbox.height);
    ctx.globalAlpha = 1;
    if (shown[place]) ctx.fillText(touchWords(touch), left + 4 * ratio, bottom - 5 * ratio);
  }
  ctx.restore();
}

/** In front: the moment that the replay shows. */
export function drawMoment(plot: uPlot, { moment, colours }: Decorations): void {
  if (moment === null) return;
  const { ctx, bbox } = plot;
  const ratio = uPlot.pxRatio;
  const x = plot.valToPos(moment, "x", true);
  if (x < bbox.left || x > bbox.left + bbox.width) return;
  ctx.save();
  ctx.fillStyle = colours.of("calm");
  ctx.fillRect(x - ratio, bbox.top, 2 * ratio, bbox.height);
  ctx.restore();
}

/** A sampled study: one mark for each draw, over two of the drawn parameters. */
import { scaleLinear, scaleLog } from "d3-scale";
import { memo } from "react";
import type { StudyDetail } from "../../api/types";
import { FAILED_STYLE, classStyle } from "../glossary/class-style";
import { plain } from "../../units/units";
import { axisTitle, LABEL_SIZE, LEGEND_STEP, legendPlaces, TITLE_SIZE, type Frame } from "./geometry";
import type { Axis } from "./layout";
import { rangeOf, shownAt } from "./layout";
import { CaptionText, columnTitle, legendNames, NumberLegend, pictureFrame, type Caption, type Paper } from "./StudyMap";
import { fitting, numberWords, textWidth } from "./ticks";
import type { Rows } from "./use-study";
import { viridis } from "./viridis";

const INK = "#10151c";
const TICKS = 7;
const SMALLEST: Frame = { width: 420, height: 320 };

export interface ScatterProps {
  readonly study: StudyDetail;
  readonly rows: Rows;
  readonly x: Axis;
  /** Null where a single parameter is drawn: then the measure itself stands upright. */
  readonly y: Axis | null;
  readonly column: string;
  readonly paper: Paper;
  readonly frame: Frame;
  readonly selected: number | null;
  /** Null where the picture is a figure. */
  readonly onSelect: ((cell: number) => void) | null;
  readonly caption: Caption | null;
}

interface Ticked {
  readonly at: (value: number) => number;
  readonly ticks: readonly { readonly value: number; readonly text: string }[];
}

/** Round ticks between these places; logarithmic where the draws are, and stand above zero. */
export function tickedScale(range: readonly [number, number], places: readonly [number, number], logarithmic: boolean): Ticked {
  const [low, high] = range[0] === range[1] ? [range[0] - 0.5, range[1] + 0.5] : range;
  if (logarithmic && low > 0) {
    const at = scaleLog([low, high], [...places]);
    const decades = at.ticks(TICKS);
    const values = decades.length > 2 * TICKS ? decades.filter((value) => Number.isInteger(Number(Math.log10(value).toFixed(9)))) : decades;
    return { at, ticks: values.map((value) => ({ value, text: plain(Number(value.toPrecision(3))) })) };
  }
  const at = scaleLinear([low, high], [...places]);
  const values = at.ticks(TICKS);
  const texts = numberWords(values);
  return { at, ticks: values.map((value, number) => ({ value, text: texts[number] ?? "" })) };
}

interface MarkProps {
  readonly cell: number;
  readonly x: number;
  readonly y: number;
  readonly colour: string;
  readonly letter: string;
  readonly words: string;
  readonly chosen: boolean;
  readonly paper: Paper;
  readonly onSelect: ((cell: number) => void) | null;
}

const Mark = memo(function Mark({ cell, x, y, colour, letter, words, chosen, paper, onSelect }: MarkProps) {
  const picture = (
    <>
      <circle r={chosen ? 9 : 6.500} fill={colour} stroke={chosen ? paper.ink : paper.page} strokeWidth={chosen ? 2.500 : 1} />
      {letter !== "" && (
        <text y={3} fontSize={8.500} textAnchor="middle" fill={INK}>
          {letter}
        </text>
      )}
    </>
  );
  const at = `translate(${x} ${y})`;
  if (onSelect === null) return <g transform={at}>{picture}</g>;
  return (
    <g role="button" tabIndex={-1} aria-label={words} data-cell={cell} style={{ cursor: "pointer" }} transform={at} onClick={() => { onSelect(cell); }}>
      <title>{words}</title>
      {picture}
    </g>
  );
});

function Marks({ props, across, up, upright }: { readonly props: ScatterProps; readonly across: Ticked; readonly up: Ticked; readonly upright: string }) {
  const { rows, x, column, paper, selected, onSelect } = props;
  const range = rangeOf(rows.values(), column);
  return (
    <>
      {[...rows].map(([cell, row]) => {
        const [atX, atY] = [row[x.path], row[upright]];
        if (typeof atX !== "number" || typeof atY !== "number") return null;
        const shown = shownAt([row], column);
        const style = shown.kind === "class" ? classStyle(shown.name) : FAILED_STYLE;
        const colour = shown.kind === "number" && range !== null ? viridis((shown.value - range[0]) / (range[1] - range[0] || 1)) : style.colour;
        const words = `${axisTitle(x)} ${plain(Number(atX.toPrecision(4)))}: ${shown.kind === "number" ? plain(Number(shown.value.toPrecision(4))) : style.words}`;
        return <Mark key={cell} cell={cell} x={across.at(atX)} y={up.at(atY)} colour={colour} letter={shown.kind === "class" ? style.letter : ""} words={words} chosen={onSelect !== null && cell === selected} paper={paper} onSelect={onSelect} />;
      })}
    </>
  );
}

function Legend({ props, x, y, width }: { readonly props: ScatterProps; readonly x: number; readonly y: number; readonly width: number }) {
  const { study, rows, column, paper } = props;
  const range = rangeOf(rows.values(), column);
  const names = legendNames(rows, column, null);
  if (names.length === 0) return range && <NumberLegend range={range} title={columnTitle(study, column)} paper={paper} x={x} y={y} />;
  const places = legendPlaces(names.map((name) => classStyle(name).words), width);
  return (
    <g>
      {names.map((name, number) => (
        <g key={name} transform={`translate(${x + (places[number]?.x ?? 0)} ${y + (places[number]?.line ?? 0) * LEGEND_STEP})`}>
          <circle cx={7} cy={7} r={6.500} fill={classStyle(name).colour} />
          <text x={7} y={10} fontSize={8.500} textAnchor="middle" fill={INK}>
            {classStyle(name).letter}
          </text>
          <text x={20} y={11} fontSize={TITLE_SIZE} fill={paper.ink}>
            {classStyle(name).words}
          </text>
        </g>
      ))}
    </g>
  );
}

const isLogarithmic = (axis: Axis | null): boolean => axis?.drawn_from?.spacing === "logarithmic";

export function StudyScatter(props: ScatterProps) {
  const { study, rows, x, y, column, paper, frame, caption } = props;
  const upright = y?.path ?? (rangeOf(rows.values(), column) === null ? "peak_tip_force" : column);
  const [xRange, yRange] = [rangeOf(rows.values(), x.path), rangeOf(rows.values(), upright)];
  if (xRange === null || yRange === null) return null;
  const { width, height } = { width: Math.max(frame.width, SMALLEST.width), height: Math.max(frame.height, SMALLEST.height) };
  const top = caption === null ? 14 : 56;
  const bottom = height - 92;
  const up = tickedScale(yRange, [bottom - 12, top + 12], isLogarithmic(y));
  const left = TITLE_SIZE + 24 + Math.max(...up.ticks.map(({ text }) => textWidth(text, LABEL_SIZE)));
  const across = tickedScale(xRange, [left + 12, width - 32], isLogarithmic(x));
  const uprightUnit = study.columns.find((each) => each.name === upright)?.unit ?? "1";
  return (
    <svg {...pictureFrame({ width, height }, caption !== null)} aria-label={`Draws of ${study.name}`}>
      <rect width={width} height={height} fill={paper.page} />
      {caption && <CaptionText caption={caption} paper={paper} x={16} />}
      {across.ticks.map(({ value, text }) => (
        <g key={value}>
          <line x1={across.at(value)} x2={across.at(value)} y1={top} y2={bottom} stroke={paper.line} />
          <text x={across.at(value)} y={bottom + 16} fontSize={LABEL_SIZE} textAnchor="middle" fill={paper.dim}>
            {text}
          </text>
        </g>
      ))}
      {up.ticks.map(({ value, text }) => (
        <g key={value}>
          <line x1={left} x2={width - 20} y1={up.at(value)} y2={up.at(value)} stroke={paper.line} />
          <text x={left - 8} y={up.at(value) + 4} fontSize={LABEL_SIZE} textAnchor="end" fill={paper.dim}>
            {text}
          </text>
        </g>
      ))}
      <text x={(left + width - 20) / 2} y={bottom + 36} fontSize={TITLE_SIZE} textAnchor="middle" fill={paper.ink}>
        {fitting([axisTitle(x)], width - left - 20, TITLE_SIZE)}
      </text>
      <text transform={`translate(${TITLE_SIZE + 2} ${(bottom + top) / 2}) rotate(-90)`} fontSize={TITLE_SIZE} textAnchor="middle" fill={paper.ink}>
        {fitting([axisTitle(y ?? { path: upright, unit: uprightUnit })], bottom - top, TITLE_SIZE)}
      </text>
      <Marks props={props} across={across} up={up} upright={upright} />
      <Legend props={props} x={left} y={bottom + 48} width={width - left - 20} />
    </svg>
  );
}

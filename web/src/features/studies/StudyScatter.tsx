/** A sampled study: one mark for each draw, over two of the drawn parameters. */
import type { StudyDetail } from "../../api/types";
import { plain } from "../../units/units";
import type { Axis } from "./layout";
import { rangeOf, shownAt } from "./layout";
import { FAILED_LOOK, inOrder, lookOf } from "../../theme/looks";
import { viridis } from "./viridis";
import { axisTitle, type Paper } from "./StudyMap";
import type { Rows } from "./use-study";

const WIDTH = 760;
const HEIGHT = 470;
const BOX = { left: 70, top: 14, right: 20, bottom: 84 };
const TICKS = 6;

interface ScatterProps {
  readonly study: StudyDetail;
  readonly rows: Rows;
  readonly x: Axis;
  /** Null where a single parameter is drawn: then the measure itself stands upright. */
  readonly y: Axis | null;
  readonly column: string;
  readonly paper: Paper;
  readonly selected: number | null;
  readonly onSelect: (cell: number) => void;
}

interface Scale {
  readonly at: (value: number) => number;
  readonly ticks: readonly number[];
}

function scale(range: readonly [number, number], from: number, to: number): Scale {
  const [low, high] = range[0] === range[1] ? [range[0] - 0.5, range[1] + 0.5] : range;
  const step = (high - low) / (TICKS - 1);
  return {
    at: (value) => from + ((value - low) / (high - low)) * (to - from),
    ticks: Array.from({ length: TICKS }, (_, place) => low + place * step),
  };
}

const short = (value: number): string => plain(Number(value.toPrecision(3)));

export function StudyScatter({ study, rows, x, y, column, paper, selected, onSelect }: ScatterProps) {
  const range = rangeOf(rows.values(), column);
  const upright = y?.path ?? (range === null ? "peak_tip_force" : column);
  const [xRange, yRange] = [rangeOf(rows.values(), x.path), rangeOf(rows.values(), upright)];
  if (xRange === null || yRange === null) return null;
  const across = scale(xRange, BOX.left, WIDTH - BOX.right);
  const up = scale(yRange, HEIGHT - BOX.bottom, BOX.top);
  const names = new Set([...rows.values()].map((row) => row[column]).filter((value) => typeof value === "string" || typeof value === "boolean").map(String));
  const uprightUnit = study.columns.find((each) => each.name === upright)?.unit ?? "1";
  return (
    <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} width="100%" height="100%" preserveAspectRatio="xMidYMin meet" fontFamily="Inter, system-ui, sans-serif" role="group" aria-label={`Draws of ${study.name}`}>
      <rect width={WIDTH} height={HEIGHT} fill={paper.page} />
      {across.ticks.map((tick) => (
        <g key={tick}>
          <line x1={across.at(tick)} x2={across.at(tick)} y1={BOX.top} y2={HEIGHT - BOX.bottom} stroke={paper.line} />
          <text x={across.at(tick)} y={HEIGHT - BOX.bottom + 16} fontSize={11} textAnchor="middle" fill={paper.dim}>{short(tick)}</text>
        </g>
      ))}
      {up.ticks.map((tick) => (
        <g key={tick}>
          <line x1={BOX.left} x2={WIDTH - BOX.right} y1={up.at(tick)} y2={up.at(tick)} stroke={paper.line} />
          <text x={BOX.left - 8} y={up.at(tick) + 4} fontSize={11} textAnchor="end" fill={paper.dim}>{short(tick)}</text>
        </g>
      ))}
      <text x={(BOX.left + WIDTH - BOX.right) / 2} y={HEIGHT - BOX.bottom + 34} fontSize={12} textAnchor="middle" fill={paper.ink}>{axisTitle(x)}</text>
      <text transform={`translate(16 ${(HEIGHT - BOX.bottom + BOX.top) / 2}) rotate(-90)`} fontSize={12} textAnchor="middle" fill={paper.ink}>
        {axisTitle(y ?? { path: upright, unit: uprightUnit })}
      </text>
      {[...rows].map(([cell, row]) => {
        const [atX, atY] = [row[x.path], row[upright]];
        if (typeof atX !== "number" || typeof atY !== "number") return null;
        const shown = shownAt([row], column);
        const look = shown.kind === "class" ? lookOf(shown.name) : FAILED_LOOK;
        const colour = shown.kind === "number" && range !== null ? viridis((shown.value - range[0]) / (range[1] - range[0] || 1)) : look.colour;
        const words = `${axisTitle(x)} ${short(atX)}: ${shown.kind === "number" ? short(shown.value) : look.words}`;
        return (
          <g key={cell} role="button" tabIndex={-1} aria-label={words} data-cell={cell} style={{ cursor: "pointer" }} transform={`translate(${across.at(atX)} ${up.at(atY)})`} onClick={() => { onSelect(cell); }}>
            <title>{words}</title>
            <circle r={cell === selected ? 9 : 6.500} fill={colour} stroke={cell === selected ? paper.ink : paper.page} strokeWidth={cell === selected ? 2.500 : 1} />
            {shown.kind === "class" && <text y={3} fontSize={8.500} textAnchor="middle" fill="#10151c">{look.letter}</text>}
          </g>
        );
      })}
      {inOrder(names).map((name, place) => (
        <g key={name} transform={`translate(${BOX.left + (place % 3) * 210} ${HEIGHT - 36 + Math.floor(place / 3) * 18})`}>
          <circle cx={7} cy={7} r={6.500} fill={lookOf(name).colour} />
          <text x={7} y={10} fontSize={8.500} textAnchor="middle" fill="#10151c">{lookOf(name).letter}</text>
          <text x={20} y={11} fontSize={11} fill={paper.ink}>{lookOf(name).words}</text>
        </g>
      ))}
    </svg>
  );
}

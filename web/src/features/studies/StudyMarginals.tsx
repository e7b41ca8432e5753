/** A measure over each varied parameter alone, as one SVG: shares of classes stacked, or median, quartiles and 5 to 95 % of numbers. */
import type { StudyDetail } from "../../api/types";
import { classStyle, inOrder } from "../glossary/class-style";
import { axisTitle, LABEL_SIZE, LEGEND_STEP, legendPlaces, TITLE_SIZE, type Frame } from "./geometry";
import { rangeOf, type Axis } from "./layout";
import { groupsOf, spreadOf, type Group, type Spread } from "./marginals";
import { CaptionText, ClassLegend, columnTitle, legendNames, pictureFrame, type Caption, type Paper } from "./StudyMap";
import { tickedScale } from "./StudyScatter";
import { fitting, textWidth } from "./ticks";
import type { Rows } from "./use-study";
import { viridis } from "./viridis";

const LEFT = 58;
const RIGHT = 16;
const TOP = 30;
const FOOT = 46;
const GAP = 6;
const LEAST: Frame = { width: 300, height: 190 };

export interface MarginalsProps {
  readonly study: StudyDetail;
  readonly rows: Rows;
  readonly column: string;
  readonly paper: Paper;
  readonly frame: Frame;
  /** Of a figure. */
  readonly caption: Caption | null;
  /** What numbers span; what there is without it. */
  readonly span?: readonly [number, number] | null;
}

interface PanelProps {
  readonly axis: Axis;
  readonly groups: readonly Group[];
  readonly column: string;
  readonly paper: Paper;
  readonly size: Frame;
  readonly range: readonly [number, number];
  readonly classed: boolean;
}

const percent = (share: number): string => `${Math.round(100 * share)} %`;

function wordsOf(spread: Spread): string {
  if (spread.kind === "none") return "no value";
  if (spread.kind === "classes") return `${[...spread.shares].map(([name, share]) => `${classStyle(name).words} ${percent(share)}`).join(", ")}, of ${spread.count}`;
  const [low, median, high] = [spread.low, spread.median, spread.high].map((value) => String(Number(value.toPrecision(4))));
  return `median ${median ?? ""}, 5 to 95 %: ${low ?? ""} to ${high ?? ""}, of ${spread.count}`;
}

function Shares({ shares, x, width, at, paper }: { readonly shares: ReadonlyMap<string, number>; readonly x: number; readonly width: number; readonly at: (value: number) => number; readonly paper: Paper }) {
  const names = inOrder(shares.keys());
  return names.map((name, place) => {
    const below = names.slice(0, place).reduce((sum, each) => sum + (shares.get(each) ?? 0), 0);
    const share = shares.get(name) ?? 0;
    return <rect key={name} x={x} width={width} y={at(below + share)} height={at(below) - at(below + share)} fill={classStyle(name).colour} stroke={paper.page} strokeWidth={0.500} />;
  });
}

function Numbers({ spread, x, width, at, paper }: { readonly spread: Spread & { readonly kind: "numbers" }; readonly x: number; readonly width: number; readonly at: (value: number) => number; readonly paper: Paper }) {
  const middle = x + width / 2;
  return (
    <>
      <line x1={middle} x2={middle} y1={at(spread.low)} y2={at(spread.high)} stroke={paper.dim} />
      <rect x={x} width={width} y={at(spread.threeQuarters)} height={Math.max(1, at(spread.quarter) - at(spread.threeQuarters))} fill={viridis(0.45)} fillOpacity={0.8} />
      <line x1={x} x2={x + width} y1={at(spread.median)} y2={at(spread.median)} stroke={paper.ink} strokeWidth={2} />
    </>
  );
}

function Panel({ axis, groups, column, paper, size, range, classed }: PanelProps) {
  const foot = size.height - FOOT;
  const scale = tickedScale(classed ? [0, 1] : range, [foot, TOP], false);
  const step = (size.width - LEFT - RIGHT) / groups.length;
  const width = Math.min(46, step - GAP);
  const crowded = Math.ceil((Math.max(...groups.map(({ words }) => textWidth(words, LABEL_SIZE))) + GAP) / step);
  return (
    <>
      {scale.ticks.map(({ value, text }) => (
        <g key={value}>
          <line x1={LEFT} x2={size.width - RIGHT} y1={scale.at(value)} y2={scale.at(value)} stroke={paper.line} />
          <text x={LEFT - 6} y={scale.at(value) + 3.500} fontSize={LABEL_SIZE} textAnchor="end" fill={paper.dim}>
            {classed ? percent(value) : text}
          </text>
        </g>
      ))}
      {groups.map(({ words, rows }, place) => {
        const spread = spreadOf(rows, column);
        const x = LEFT + (place + 0.5) * step - width / 2;
        return (
          <g key={`${place} ${words}`}>
            <title>{`${axisTitle(axis)} ${words}: ${wordsOf(spread)}`}</title>
            {spread.kind === "classes" && <Shares shares={spread.shares} x={x} width={width} at={scale.at} paper={paper} />}
            {spread.kind === "numbers" && <Numbers spread={spread} x={x} width={width} at={scale.at} paper={paper} />}
            {place % crowded === 0 && (
              <text x={x + width / 2} y={foot + 15} fontSize={LABEL_SIZE} textAnchor="middle" fill={paper.dim}>
                {words}
              </text>
            )}
          </g>
        );
      })}
      <text x={(LEFT + size.width - RIGHT) / 2} y={foot + 34} fontSize={TITLE_SIZE} textAnchor="middle" fill={paper.ink}>
        {fitting([axisTitle(axis)], size.width - LEFT - RIGHT, TITLE_SIZE)}
      </text>
    </>
  );
}

/** Panels beside one another, as wide and as high as there is room, never less than is of use. */
function gridOf(count: number, { width, height }: Frame): { readonly across: number; readonly size: Frame } {
  const across = Math.max(1, Math.min(count, Math.floor(width / Math.max(LEAST.width, width / 3))));
  const size = { width: Math.max(LEAST.width, width / across), height: Math.max(LEAST.height, Math.min(320, height / Math.ceil(count / across))) };
  return { across, size };
}

export function StudyMarginals({ study, rows, column, paper, frame, caption, span = null }: MarginalsProps) {
  const names = legendNames(rows, column, null);
  const head = caption === null ? 0 : 46;
  const legend = names.length === 0 ? 0 : 16 + LEGEND_STEP * (1 + Math.max(0, ...legendPlaces(names.map((name) => classStyle(name).words), Math.max(LEAST.width, frame.width) - 32).map(({ line }) => line)));
  const { across, size } = gridOf(study.axes.length, { width: frame.width, height: frame.height - head - legend });
  const whole = { width: across * size.width, height: head + Math.ceil(study.axes.length / across) * size.height + legend };
  const range = span ?? rangeOf(rows.values(), column) ?? [0, 1];
  return (
    <svg {...pictureFrame(whole, caption !== null)} aria-label={`${columnTitle(study, column)} of ${study.name} over each parameter`}>
      <rect width={whole.width} height={whole.height} fill={paper.page} />
      {caption && <CaptionText caption={caption} paper={paper} x={16} />}
      {study.axes.map((axis, place) => (
        <g key={axis.path} transform={`translate(${(place % across) * size.width} ${head + Math.floor(place / across) * size.height})`} role="img" aria-label={`${columnTitle(study, column)} over ${axisTitle(axis)}`}>
          <text x={LEFT} y={16} fontSize={12.500} fontWeight={600} fill={paper.ink}>
            {columnTitle(study, column)}
          </text>
          <Panel axis={axis} groups={groupsOf(axis, rows.values())} column={column} paper={paper} size={size} range={range} classed={names.length > 0} />
        </g>
      ))}
      {names.length > 0 && <ClassLegend names={names} paper={paper} compared={false} x={16} y={whole.height - legend + 8} width={whole.width - 32} />}
    </svg>
  );
}

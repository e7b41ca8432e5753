/** The map of a grid study as one SVG: a panel for each value of the third axis, the published ones beside. */
import { useId } from "react";
import type { StudyDetail, StudyRow } from "../../api/types";
import { shown as shownUnit, plain } from "../../units/units";
import { panelsOf, rangeOf, shownAt, type GridAxis, type Panel, type Shown, type Spread, type Value } from "./layout";
import { FAILED_LOOK, inOrder, lookOf } from "../../theme/looks";
import { inkOn, viridis } from "./viridis";
import type { PublishedClasses } from "./published";
import type { Rows } from "./use-study";

/** A cell of a large grid; those of a small one are larger, so that the axes have room for their words. */
const SMALLEST_CELL = 17;
const LARGEST_CELL = 44;
const GRID = 187;
const LEFT = 54;
const TOP = 28;
const BOTTOM = 44;
const GAP = 14;
const LEGEND = 44;

/** Colours of ink and paper; explicit, so that the picture is the same when it is taken out of the page. */
export interface Paper {
  readonly page: string;
  readonly ink: string;
  readonly dim: string;
  readonly line: string;
  readonly empty: string;
}

export interface MapProps {
  readonly study: StudyDetail;
  readonly rows: Rows;
  readonly spread: Spread;
  readonly chosen: ReadonlyMap<string, number>;
  readonly column: string;
  /** What the paper prints, where it can be laid beside; null where it is not wanted. */
  readonly published: PublishedClasses | null;
  readonly paper: Paper;
  readonly selected: number | null;
  readonly onSelect: (cell: number) => void;
  /** Panels beside each other. */
  readonly across: number;
}

const unitOf = (unit: string): string => shownUnit(unit, "rad").unit;

/** The end of its path, by which a person knows a parameter. */
export const axisName = (path: string): string => path.split(".").slice(-2).join(" ").replaceAll("_", " ");

export const axisTitle = (axis: { readonly path: string; readonly unit: string }): string => {
  const unit = unitOf(axis.unit);
  const name = axisName(axis.path);
  return unit === "" ? name : `${name} [${unit}]`;
};

const valueWords = (value: Value): string => (typeof value === "number" ? plain(value) : value);

function cellSize({ x, y }: Spread): number {
  const most = Math.max(x.values.length, y?.values.length ?? 1);
  return Math.min(LARGEST_CELL, Math.max(SMALLEST_CELL, Math.floor(GRID / most)));
}

const panelWidth = (spread: Spread): number => LEFT + spread.x.values.length * cellSize(spread) + GAP;
const panelHeight = (spread: Spread): number => TOP + (spread.y?.values.length ?? 1) * cellSize(spread) + BOTTOM;

/** Size of the whole picture in its own units. */
export function mapSize(spread: Spread, across: number, compared: boolean): { width: number; height: number } {
  const panels = spread.facet?.values.length ?? 1;
  const columns = Math.min(across, panels);
  const lines = Math.ceil(panels / columns) * (compared ? 2 : 1);
  return { width: Math.max(columns * panelWidth(spread), 460), height: lines * panelHeight(spread) + LEGEND };
}

interface Colouring {
  readonly colour: (shown: Shown) => string;
  readonly ink: (shown: Shown) => string;
  readonly letter: (shown: Shown) => string;
}

function colouringOf(range: readonly [number, number] | null, paper: Paper): Colouring {
  const [low, high] = range ?? [0, 1];
  const fraction = (value: number): number => (high > low ? (value - low) / (high - low) : 0.5);
  return {
    colour: (shown) => {
      if (shown.kind === "class") return lookOf(shown.name).colour;
      if (shown.kind === "number") return viridis(fraction(shown.value));
      return shown.kind === "failed" ? FAILED_LOOK.colour : paper.empty;
    },
    ink: (shown) => (shown.kind === "number" ? inkOn(fraction(shown.value)) : "#10151c"),
    letter: (shown) => {
      if (shown.kind === "class") return lookOf(shown.name).letter;
      return shown.kind === "failed" ? FAILED_LOOK.letter : "";
    },
  };
}

function words(shown: Shown): string {
  if (shown.kind === "class") return `${lookOf(shown.name).words}${shown.share < 1 ? ` (${Math.round(100 * shown.share)} %)` : ""}`;
  if (shown.kind === "number") return plain(shown.value);
  return shown.kind === "failed" ? FAILED_LOOK.words : "not flown yet";
}

interface PanelProps extends MapProps {
  readonly panel: Panel;
  readonly title: string;
  readonly colouring: Colouring;
  readonly x: number;
  readonly y: number;
  /** What the paper prints in place of what was flown. */
  readonly printed: boolean;
}

function axisValue(axis: GridAxis | null, place: number): Value | null {
  return axis?.values[place] ?? null;
}

function MapCell({ props, place }: { readonly props: PanelProps; readonly place: Panel["places"][number] }) {
  const { spread, panel, rows, column, published, colouring, printed, paper, selected, onSelect } = props;
  const lines = spread.y?.values.length ?? 1;
  const [xValue, yValue] = [axisValue(spread.x, place.column), axisValue(spread.y, place.row)];
  const theirs = published?.at(panel.facet, xValue, yValue) ?? null;
  const flown = place.cells.map((cell) => rows.get(cell)).filter((row): row is StudyRow => row !== undefined);
  const ours = shownAt(flown, column);
  const shown: Shown = printed ? (theirs === null ? { kind: "empty" } : { kind: "class", name: theirs, share: 1 }) : ours;
  const differs = !printed && theirs !== null && ours.kind === "class" && ours.name !== theirs;
  const cell = place.cells[0] ?? 0;
  const where = [axisTitle(spread.x), valueWords(xValue ?? ""), spread.y ? axisTitle(spread.y) : "", valueWords(yValue ?? "")].join(" ");
  const label = `${where}: ${words(shown)}${differs ? `; published ${lookOf(theirs).words}` : ""}`;
  const size = cellSize(spread);
  const [x, y] = [LEFT + place.column * size, TOP + (lines - 1 - place.row) * size];
  const chosen = !printed && place.cells.includes(selected ?? -1);
  const select = () => {
    onSelect(cell);
  };
  return (
    <g
      role="button"
      tabIndex={chosen || (selected === null && place.column === 0 && place.row === 0 && !printed) ? 0 : -1}
      aria-label={label}
      aria-pressed={chosen}
      data-cell={printed ? undefined : cell}
      data-shown={shown.kind === "class" ? shown.name : shown.kind}
      style={{ cursor: "pointer", outlineOffset: -2 }}
      onClick={select}
      onKeyDown={(event) => {
        if (event.key === "Enter" || event.key === " ") select();
      }}
    >
      <title>{label}</title>
      <rect x={x} y={y} width={size} height={size} fill={colouring.colour(shown)} stroke={paper.page} strokeWidth={1} />
      <text x={x + size / 2} y={y + size / 2 + 3.300} textAnchor="middle" fontSize={9} fill={colouring.ink(shown)} opacity={0.85}>
        {colouring.letter(shown)}
      </text>
      {differs && <rect x={x + 1.500} y={y + 1.500} width={size - 3} height={size - 3} fill="none" stroke="#10151c" strokeWidth={1.500} strokeDasharray="3 2" />}
      {chosen && <rect x={x + 1} y={y + 1} width={size - 2} height={size - 2} fill="none" stroke={paper.ink} strokeWidth={2.500} />}
    </g>
  );
}

/** Every second label where values are many: they would run into each other. */
const labelled = (count: number, place: number): boolean => count <= 8 || place % 2 === 0;

function MapPanel(props: PanelProps) {
  const { spread, panel, title, paper, x, y } = props;
  const lines = spread.y?.values.length ?? 1;
  const size = cellSize(spread);
  const width = spread.x.values.length * size;
  const foot = TOP + lines * size;
  return (
    <g transform={`translate(${x} ${y})`} role="group" aria-label={title}>
      <text x={LEFT} y={TOP - 10} fontSize={12.500} fontWeight={600} fill={paper.ink}>
        {title}
      </text>
      {panel.places.map((place) => (
        <MapCell key={`${place.column} ${place.row}`} props={props} place={place} />
      ))}
      {spread.x.values.map((value, column) =>
        labelled(spread.x.values.length, column) ? (
          <text key={column} x={LEFT + (column + 0.5) * size} y={foot + 14} fontSize={10.500} textAnchor="middle" fill={paper.dim}>
            {valueWords(value)}
          </text>
        ) : null,
      )}
      <text x={LEFT + width / 2} y={foot + 31} fontSize={11} textAnchor="middle" fill={paper.ink}>
        {axisTitle(spread.x)}
      </text>
      {spread.y?.values.map((value, row) =>
        labelled(lines, row) ? (
          <text key={row} x={LEFT - 6} y={TOP + (lines - row - 0.5) * size + 3.500} fontSize={10.500} textAnchor="end" fill={paper.dim}>
            {valueWords(value)}
          </text>
        ) : null,
      )}
      {spread.y && (
        <text transform={`translate(14 ${TOP + (lines * size) / 2}) rotate(-90)`} fontSize={11} textAnchor="middle" fill={paper.ink}>
          {axisTitle(spread.y)}
        </text>
      )}
    </g>
  );
}

function ClassLegend({ names, paper, compared, y }: { readonly names: readonly string[]; readonly paper: Paper; readonly compared: boolean; readonly y: number }) {
  const entries = [...names.map((name) => ({ key: name, ...lookOf(name), dashed: false }))];
  if (compared) entries.push({ key: "differs", colour: paper.page, letter: "", words: "differs from the paper", dashed: true });
  let x = LEFT;
  return (
    <g>
      {entries.map((entry) => {
        const at = x;
        x += 30 + entry.words.length * 6.200;
        return (
          <g key={entry.key} transform={`translate(${at} ${y})`}>
            <rect width={15} height={15} fill={entry.colour} stroke={entry.dashed ? paper.ink : paper.line} strokeWidth={entry.dashed ? 2 : 1} strokeDasharray={entry.dashed ? "3 2" : undefined} />
            <text x={7.500} y={11.300} textAnchor="middle" fontSize={10} fill="#10151c">
              {entry.letter}
            </text>
            <text x={20} y={11.500} fontSize={11} fill={paper.ink}>
              {entry.words}
            </text>
          </g>
        );
      })}
    </g>
  );
}

function NumberLegend({ range, title, paper, y }: { readonly range: readonly [number, number]; readonly title: string; readonly paper: Paper; readonly y: number }) {
  const gradient = useId();
  return (
    <g transform={`translate(${LEFT} ${y})`}>
      <defs>
        <linearGradient id={gradient}>
          {Array.from({ length: 11 }, (_, place) => (
            <stop key={place} offset={place / 10} stopColor={viridis(place / 10)} />
          ))}
        </linearGradient>
      </defs>
      <rect width={220} height={12} fill={`url(#${gradient})`} />
      <text y={25} fontSize={10.500} fill={paper.dim}>
        {plain(Number(range[0].toPrecision(3)))}
      </text>
      <text x={220} y={25} fontSize={10.500} textAnchor="end" fill={paper.dim}>
        {plain(Number(range[1].toPrecision(3)))}
      </text>
      <text x={232} y={10.500} fontSize={11} fill={paper.ink}>
        {title}
      </text>
    </g>
  );
}

export function StudyMap(props: MapProps) {
  const { study, rows, spread, chosen, column, published, paper, across } = props;
  const panels = panelsOf(study, spread, chosen);
  const columns = Math.min(across, panels.length);
  const about = study.columns.find((each) => each.name === column);
  const range = rangeOf(rows.values(), column);
  const colouring = colouringOf(range, paper);
  const compared = published !== null;
  const size = mapSize(spread, across, compared);
  const names = new Set([...rows.values()].map((row) => row[column]).filter((value) => typeof value === "string" || typeof value === "boolean").map(String));
  for (const name of compared ? published.names : []) names.add(name);
  const place = (number: number, printed: boolean) => ({
    x: (number % columns) * panelWidth(spread),
    y: (Math.floor(number / columns) * (compared ? 2 : 1) + (printed ? 1 : 0)) * panelHeight(spread),
  });
  const title = (panel: Panel): string =>
    spread.facet === null || panel.facet === null ? "" : `${spread.facet.path.split(".").at(-1) ?? ""} ${valueWords(panel.facet)} ${unitOf(spread.facet.unit)}`;
  return (
    <svg viewBox={`0 0 ${size.width} ${size.height}`} width="100%" height="100%" preserveAspectRatio="xMidYMin meet" fontFamily="Inter, system-ui, sans-serif" role="group" aria-label={`Map of ${study.name}: ${about?.description ?? column}`}>
      <rect width={size.width} height={size.height} fill={paper.page} />
      {panels.map((panel, number) => (
        <MapPanel key={`ours ${number}`} {...props} panel={panel} title={title(panel)} colouring={colouring} printed={false} {...place(number, false)} />
      ))}
      {compared &&
        panels.map((panel, number) =>
          published.has(panel.facet) ? (
            <MapPanel key={`printed ${number}`} {...props} panel={panel} title={`${title(panel)}, published`} colouring={colouring} printed {...place(number, true)} />
          ) : (
            <g key={`printed ${number}`} transform={`translate(${place(number, true).x + LEFT} ${place(number, true).y + TOP})`} fill={paper.dim}>
              <text y={-10} fontSize={12.500} fontWeight={600}>{`${title(panel)}, published`}</text>
              <text y={8} fontSize={11}>
                This table is not at hand.
              </text>
            </g>
          ),
        )}
      {names.size > 0 ? (
        <ClassLegend names={inOrder(names)} paper={paper} compared={compared} y={size.height - 28} />
      ) : (
        range && <NumberLegend range={range} title={`${column.replaceAll("_", " ")} [${unitOf(about?.unit ?? "1") || "1"}]`} paper={paper} y={size.height - 34} />
      )}
    </svg>
  );
}

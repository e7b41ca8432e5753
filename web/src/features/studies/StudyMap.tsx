/** The map of a grid study as one SVG: a panel for each value of the third axis, the published ones beside. */
import { memo, type KeyboardEvent, type SVGProps } from "react";
import type { StudyRow } from "../../api/types";
import { FAILED_STYLE, inOrder, classStyle } from "../glossary/class-style";
import { FIGURE_FONT } from "../../ui/export/figure-file";
import { shown as shownUnit, plain } from "../../units/units";
import { axisTitle, geometryWith, LABEL_SIZE, LEGEND_MARGIN, LEGEND_STEP, legendPlaces, LETTERED_CELL, TITLE_SIZE, type Frame, type Geometry } from "./geometry";
import { panelsOf, rangeOf, shownAt, type GridAxis, type Mapped, type Panel, type Shown, type Spread, type Value } from "./layout";
import type { PublishedClasses } from "./published";
import { numberWords } from "./ticks";
import type { Rows } from "./use-study";
import { inkOn, viridis } from "./viridis";

/** Colours of ink and paper; explicit, so that the picture is the same when it is taken out of the page. */
export interface Paper {
  readonly page: string;
  readonly ink: string;
  readonly dim: string;
  readonly line: string;
  readonly empty: string;
}

/** What a picture says of itself where it stands alone. */
export interface Caption {
  readonly title: string;
  readonly words: string;
}

export interface MapProps {
  readonly study: Mapped;
  readonly rows: Rows;
  readonly spread: Spread;
  readonly chosen: ReadonlyMap<string, number>;
  readonly column: string;
  /** What the paper prints, where it can be laid beside; null where it is not wanted. */
  readonly published: PublishedClasses | null;
  readonly paper: Paper;
  readonly frame: Frame;
  readonly selected: number | null;
  /** Null where the picture is a figure, and nothing in it can be pressed. */
  readonly onSelect: ((cell: number) => void) | null;
  /** Told which cell the pointer or the focus is on. */
  readonly onPoint?: (cell: number) => void;
  /** How sure what a cell shows is, 0 to 1: its opacity. */
  readonly sureness?: (row: StudyRow) => number;
  /** What more is said of a cell where it is named. */
  readonly detail?: (row: StudyRow) => string;
  /** What the colours of numbers span; what there is without it. */
  readonly span?: readonly [number, number] | null;
  /** A point to mark, in places of both axes, between two of them too. */
  readonly mark?: { readonly x: number; readonly y: number; readonly label: string } | null;
  /** Of a figure. */
  readonly caption: Caption | null;
}

const INK = "#10151c";
const CAPTION_HEIGHT = 46;

const unitOf = (unit: string): string => shownUnit(unit, "rad").unit;

const valueWords = (value: Value): string => (typeof value === "number" ? plain(value) : value);

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
      if (shown.kind === "class") return classStyle(shown.name).colour;
      if (shown.kind === "number") return viridis(fraction(shown.value));
      return shown.kind === "failed" ? FAILED_STYLE.colour : paper.empty;
    },
    ink: (shown) => (shown.kind === "number" ? inkOn(fraction(shown.value)) : INK),
    letter: (shown) => {
      if (shown.kind === "class") return classStyle(shown.name).letter;
      return shown.kind === "failed" ? FAILED_STYLE.letter : "";
    },
  };
}

function words(shown: Shown): string {
  if (shown.kind === "class") return `${classStyle(shown.name).words}${shown.share < 1 ? ` (${Math.round(100 * shown.share)} %)` : ""}`;
  if (shown.kind === "number") return plain(shown.value);
  if (shown.kind === "none") return "no value";
  return shown.kind === "failed" ? FAILED_STYLE.words : "not run yet";
}

interface PanelProps extends MapProps {
  readonly panel: Panel;
  readonly title: string;
  readonly colouring: Colouring;
  readonly geometry: Geometry;
  readonly x: number;
  readonly y: number;
  /** What the paper prints in place of what was flown. */
  readonly printed: boolean;
}

function axisValue(axis: GridAxis | null, place: number): Value | null {
  return axis?.values[place] ?? null;
}

interface CellProps {
  /** Null for a cell that cannot be chosen by itself: the paper's. */
  readonly cell: number;
  readonly printed: boolean;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  /** Column and line, for the keys that go from cell to cell. */
  readonly place: string;
  readonly colour: string;
  readonly opacity: number;
  readonly ink: string;
  readonly letter: string;
  readonly label: string;
  readonly shown: string;
  readonly differs: boolean;
  readonly chosen: boolean;
  readonly reached: boolean;
  readonly paper: Paper;
  readonly onSelect: ((cell: number) => void) | null;
  readonly onPoint: ((cell: number) => void) | undefined;
}

/** Drawn again only where it has changed: a map may have ten thousand. */
const MapCell = memo(function MapCell({ cell, printed, x, y, width, height, place, colour, opacity, ink, letter, label, shown, differs, chosen, reached, paper, onSelect, onPoint }: CellProps) {
  const small = Math.min(width, height);
  const picture = (
    <>
      <rect x={x} y={y} width={width} height={height} fill={colour} {...(opacity < 1 ? { fillOpacity: opacity } : {})} {...(small >= 8 ? { stroke: paper.page, strokeWidth: 1 } : {})} />
      {letter !== "" && small >= LETTERED_CELL && (
        <text x={x + width / 2} y={y + height / 2 + 3.300} textAnchor="middle" fontSize={9} fill={ink} fillOpacity={0.85}>
          {letter}
        </text>
      )}
      {differs && <rect x={x + 1.500} y={y + 1.500} width={Math.max(1, width - 3)} height={Math.max(1, height - 3)} fill="none" stroke={INK} strokeWidth={small > 10 ? 1.500 : 0.800} strokeDasharray="3 2" />}
    </>
  );
  if (onSelect === null) return picture;
  const select = () => {
    onSelect(cell);
  };
  const point = () => {
    onPoint?.(cell);
  };
  return (
    <g
      role="button"
      tabIndex={reached ? 0 : -1}
      aria-label={label}
      aria-pressed={chosen}
      data-cell={printed ? undefined : cell}
      data-shown={shown}
      data-place={place}
      style={{ cursor: "pointer", outlineOffset: -2 }}
      onClick={select}
      onFocus={point}
      onPointerEnter={point}
      onKeyDown={(event) => {
        if (event.key === "Enter" || event.key === " ") select();
      }}
    >
      <title>{label}</title>
      {picture}
      {chosen && <rect x={x + 1} y={y + 1} width={Math.max(2, width - 2)} height={Math.max(2, height - 2)} fill="none" stroke={paper.ink} strokeWidth={2.500} />}
    </g>
  );
});

/** What is known of one place of a panel, in the words and colours of its cell. */
function cellOf(props: PanelProps, place: Panel["places"][number]): CellProps {
  const { spread, panel, rows, column, published, colouring, printed, paper, selected, onSelect, onPoint, sureness, detail, geometry } = props;
  const lines = spread.y?.values.length ?? 1;
  const [xValue, yValue] = [axisValue(spread.x, place.column), axisValue(spread.y, place.row)];
  const theirs = published?.at(panel.facet, xValue, yValue) ?? null;
  const flown = place.cells.map((cell) => rows.get(cell)).filter((row): row is StudyRow => row !== undefined);
  const ours = shownAt(flown, column);
  const shown: Shown = printed ? (theirs === null ? { kind: "empty" } : { kind: "class", name: theirs, share: 1 }) : ours;
  const differs = !printed && theirs !== null && ours.kind === "class" && ours.name !== theirs;
  const where = [axisTitle(spread.x), valueWords(xValue ?? ""), spread.y ? axisTitle(spread.y) : "", valueWords(yValue ?? "")].join(" ");
  const [row] = printed ? [] : flown;
  const more = row !== undefined && detail !== undefined ? `; ${detail(row)}` : "";
  const chosen = !printed && selected !== null && place.cells.includes(selected);
  return {
    cell: place.cells[0] ?? 0,
    printed,
    x: geometry.left + place.column * geometry.wide,
    y: geometry.top + (lines - 1 - place.row) * geometry.cell,
    width: geometry.wide,
    height: geometry.cell,
    place: `${place.column} ${place.row}`,
    colour: colouring.colour(shown),
    opacity: row === undefined || sureness === undefined ? 1 : sureness(row),
    ink: colouring.ink(shown),
    letter: colouring.letter(shown),
    label: `${where}: ${words(shown)}${differs ? `; published ${classStyle(theirs).words}` : ""}${more}`,
    shown: shown.kind === "class" ? shown.name : shown.kind,
    differs,
    chosen,
    reached: chosen || (selected === null && place.column === 0 && place.row === 0 && !printed),
    paper,
    onSelect,
    onPoint,
  };
}

function Axes({ spread, geometry, paper }: { readonly spread: Spread; readonly geometry: Geometry; readonly paper: Paper }) {
  const { cell, wide, left, top, panel, x, y } = geometry;
  const lines = spread.y?.values.length ?? 1;
  const foot = top + lines * cell;
  return (
    <>
      {x.ticks.map(({ place, text }) => (
        <g key={place}>
          <line x1={left + (place + 0.5) * wide} x2={left + (place + 0.5) * wide} y1={foot} y2={foot + 3} stroke={paper.dim} />
          <text x={left + (place + 0.5) * wide} y={foot + 14} fontSize={LABEL_SIZE} textAnchor="middle" fill={paper.dim}>
            {text}
          </text>
        </g>
      ))}
      <text x={left + Math.max(spread.x.values.length * wide, 130) / 2} y={foot + 32} fontSize={TITLE_SIZE} textAnchor="middle" fill={paper.ink}>
        {x.title}
      </text>
      {y?.ticks.map(({ place, text }) => (
        <g key={place}>
          <line x1={left - 3} x2={left} y1={top + (lines - place - 0.5) * cell} y2={top + (lines - place - 0.5) * cell} stroke={paper.dim} />
          <text x={left - 6} y={top + (lines - place - 0.5) * cell + 3.500} fontSize={LABEL_SIZE} textAnchor="end" fill={paper.dim}>
            {text}
          </text>
        </g>
      ))}
      {y && (
        <text transform={`translate(${TITLE_SIZE + 1} ${Math.max(top + (lines * cell) / 2, panel.height / 2 - 12)}) rotate(-90)`} fontSize={TITLE_SIZE} textAnchor="middle" fill={paper.ink}>
          {y.title}
        </text>
      )}
    </>
  );
}

const STEPS: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** An arrow key goes to the neighbouring cell. */
function goToNeighbour(event: KeyboardEvent<SVGGElement>): void {
  const step = STEPS[event.key];
  const place = (event.target as Element).getAttribute("data-place");
  if (step === undefined || place === null) return;
  const [column = 0, row = 0] = place.split(" ").map(Number);
  event.preventDefault();
  event.currentTarget.querySelector<SVGGElement>(`[data-place="${column + step[0]} ${row + step[1]}"]`)?.focus();
}

/** Where on the map something stands: a ring that is seen on every colour. */
function Mark({ mark, spread, geometry, paper }: { readonly mark: NonNullable<MapProps["mark"]>; readonly spread: Spread; readonly geometry: Geometry; readonly paper: Paper }) {
  const lines = spread.y?.values.length ?? 1;
  const [x, y] = [geometry.left + (mark.x + 0.5) * geometry.wide, geometry.top + (lines - mark.y - 0.5) * geometry.cell];
  return (
    <g transform={`translate(${x} ${y})`} fill="none" style={{ pointerEvents: "none" }} role="img" aria-label={mark.label}>
      <circle r={6} stroke={paper.page} strokeWidth={4} />
      <circle r={6} stroke={paper.ink} strokeWidth={2} />
      <circle r={1.500} fill={paper.ink} stroke={paper.page} strokeWidth={0.800} />
    </g>
  );
}

function MapPanel(props: PanelProps) {
  const { spread, panel, title, paper, geometry, mark, x, y } = props;
  return (
    <g transform={`translate(${x} ${y})`} {...(props.onSelect === null ? {} : { role: "group", "aria-label": title, onKeyDown: goToNeighbour })}>
      <text x={geometry.left} y={geometry.top - 10} fontSize={12.500} fontWeight={600} fill={paper.ink}>
        {title}
      </text>
      {panel.places.map((place) => (
        <MapCell key={`${place.column} ${place.row}`} {...cellOf(props, place)} />
      ))}
      <Axes spread={spread} geometry={geometry} paper={paper} />
      {mark && <Mark mark={mark} spread={spread} geometry={geometry} paper={paper} />}
    </g>
  );
}

const legendWords = (names: readonly string[], compared: boolean): string[] => [...names.map((name) => classStyle(name).words), ...(compared ? ["differs from the paper"] : [])];

export function ClassLegend({ names, paper, compared, x, y, width }: { readonly names: readonly string[]; readonly paper: Paper; readonly compared: boolean; readonly x: number; readonly y: number; readonly width: number }) {
  const texts = legendWords(names, compared);
  const places = legendPlaces(texts, width);
  return (
    <g>
      {texts.map((text, number) => {
        const name = names[number];
        const style = name === undefined ? { colour: paper.page, letter: "" } : classStyle(name);
        const place = places[number] ?? { x: 0, line: 0 };
        return (
          <g key={text} transform={`translate(${x + place.x} ${y + place.line * LEGEND_STEP})`}>
            <rect width={15} height={15} fill={style.colour} stroke={name === undefined ? paper.ink : paper.line} strokeWidth={name === undefined ? 2 : 1} {...(name === undefined ? { strokeDasharray: "3 2" } : {})} />
            <text x={7.500} y={11.300} textAnchor="middle" fontSize={10} fill={INK}>
              {style.letter}
            </text>
            <text x={20} y={11.500} fontSize={TITLE_SIZE} fill={paper.ink}>
              {text}
            </text>
          </g>
        );
      })}
    </g>
  );
}

const SHADES = 44;

/** Rectangles rather than a gradient: every program that opens the figure draws them alike. */
export function NumberLegend({ range, title, paper, x, y }: { readonly range: readonly [number, number]; readonly title: string; readonly paper: Paper; readonly x: number; readonly y: number }) {
  const [low, high] = numberWords(range);
  return (
    <g transform={`translate(${x} ${y})`}>
      {Array.from({ length: SHADES }, (_, place) => (
        <rect key={place} x={place * 5} width={5.500} height={11} fill={viridis(place / (SHADES - 1))} />
      ))}
      <text y={23} fontSize={LABEL_SIZE} fill={paper.dim}>
        {low}
      </text>
      <text x={SHADES * 5} y={23} fontSize={LABEL_SIZE} textAnchor="end" fill={paper.dim}>
        {high}
      </text>
      <text x={SHADES * 5 + 12} y={10} fontSize={TITLE_SIZE} fill={paper.ink}>
        {title}
      </text>
    </g>
  );
}

export function CaptionText({ caption, paper, x }: { readonly caption: Caption; readonly paper: Paper; readonly x: number }) {
  return (
    <g>
      <text x={x} y={20} fontSize={14} fontWeight={600} fill={paper.ink}>
        {caption.title}
      </text>
      <text x={x} y={37} fontSize={LABEL_SIZE} fill={paper.dim}>
        {caption.words}
      </text>
    </g>
  );
}

function classesOf(rows: Rows, column: string): Set<string> {
  const values = [...rows.values()].map((row) => row[column]);
  return new Set(values.filter((value) => typeof value === "string" || typeof value === "boolean").map(String));
}

/** The names of classes in a legend, those of the paper too where it is laid beside. */
export function legendNames(rows: Rows, column: string, published: PublishedClasses | null): string[] {
  const names = classesOf(rows, column);
  for (const name of published?.names ?? []) names.add(name);
  return inOrder(names);
}

/** A column as a person reads it: its name, and its unit if it has one. */
export function columnTitle(study: Pick<Mapped, "columns">, column: string): string {
  const unit = unitOf(study.columns.find((each) => each.name === column)?.unit ?? "1");
  const name = column.replaceAll("_", " ");
  return unit === "" ? name : `${name} [${unit}]`;
}

/** The attributes of the picture: in the page it fills its frame, as a figure it has a size of its own. */
export function pictureFrame({ width, height }: Frame, figure: boolean): SVGProps<SVGSVGElement> {
  const common = { viewBox: `0 0 ${width} ${height}`, xmlns: "http://www.w3.org/2000/svg" };
  if (figure) return { ...common, width, height, fontFamily: FIGURE_FONT };
  // Made smaller where it must, never larger: the letters keep the size of the page's.
  const shown = { width: "100%", height: "100%", style: { maxWidth: width, maxHeight: height, margin: "0 auto", display: "block" } };
  return { ...common, ...shown, preserveAspectRatio: "xMidYMin meet", fontFamily: "Inter, system-ui, sans-serif", role: "group" };
}

/** Beside the published panels: that Becalm has no such table. */
function NotPrinted({ title, paper, geometry, x, y }: { readonly title: string; readonly paper: Paper; readonly geometry: Geometry; readonly x: number; readonly y: number }) {
  return (
    <g transform={`translate(${x + geometry.left} ${y + geometry.top})`} fill={paper.dim}>
      <text y={-10} fontSize={12.500} fontWeight={600}>
        {title}
      </text>
      <text y={8} fontSize={TITLE_SIZE}>
        The paper&apos;s table is
      </text>
      <text y={23} fontSize={TITLE_SIZE}>
        not part of Becalm.
      </text>
    </g>
  );
}

export function StudyMap(props: MapProps) {
  const { study, rows, spread, chosen, column, published, paper, frame, caption } = props;
  const panels = panelsOf(study, spread, chosen);
  const range = props.span ?? rangeOf(rows.values(), column);
  const colouring = colouringOf(range, paper);
  const compared = published !== null;
  const names = legendNames(rows, column, published);
  const legend = names.length > 0 ? legendWords(names, compared) : [];
  const geometry = geometryWith(legend, { spread, compared, frame, head: caption === null ? 0 : CAPTION_HEIGHT });
  const { size, left, across, panel: one, head } = geometry;
  const place = (number: number, printed: boolean) => ({
    x: (number % across) * one.width,
    y: head + (Math.floor(number / across) * (compared ? 2 : 1) + (printed ? 1 : 0)) * one.height,
  });
  const title = (panel: Panel): string =>
    spread.facet === null || panel.facet === null ? "" : `${spread.facet.path.split(".").at(-1)?.replaceAll("_", " ") ?? ""} ${valueWords(panel.facet)} ${unitOf(spread.facet.unit)}`.trim();
  const foot = head + Math.ceil(panels.length / across) * (compared ? 2 : 1) * one.height + 2;
  return (
    <svg {...pictureFrame(size, caption !== null)} aria-label={`Map of ${study.name}: ${columnTitle(study, column)}`}>
      <rect width={size.width} height={size.height} fill={paper.page} />
      {caption && <CaptionText caption={caption} paper={paper} x={16} />}
      {panels.map((panel, number) => (
        <MapPanel key={`ours ${number}`} {...props} panel={panel} title={title(panel)} colouring={colouring} geometry={geometry} printed={false} {...place(number, false)} />
      ))}
      {compared &&
        panels.map((panel, number) =>
          published.has(panel.facet) ? (
            <MapPanel key={`printed ${number}`} {...props} panel={panel} title={`${title(panel)}, published`} colouring={colouring} geometry={geometry} printed {...place(number, true)} />
          ) : (
            <NotPrinted key={`printed ${number}`} title={`${title(panel)}, published`} paper={paper} geometry={geometry} {...place(number, true)} />
          ),
        )}
      {names.length > 0 ? <ClassLegend names={names} paper={paper} compared={compared} x={Math.min(left, 60)} y={foot} width={size.width - LEGEND_MARGIN} /> : range && <NumberLegend range={range} title={columnTitle(study, column)} paper={paper} x={Math.min(left, 60)} y={foot} />}
    </svg>
  );
}

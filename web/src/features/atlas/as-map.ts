/** An atlas as the map of a study draws it: two axes, a row a cell. */
import type { AtlasCell, AtlasDetail, StudyRow } from "../../api/types";
import { rangeOf, type GridAxis, type Mapped, type Spread } from "../studies/layout";
import type { Rows } from "../studies/use-study";

/** The share of the futures that are caged, as a column. */
export const CAGED_SHARE = "caged_share";

type Axis = AtlasDetail["x"];

const gridAxis = ({ path, unit, description, values }: Axis): GridAxis => ({ path, unit, description, values, count: values.length, drawn_from: null });

export const spreadOf = ({ x, y }: AtlasDetail): Spread => ({ x: gridAxis(x), y: gridAxis(y), facet: null });

export function mappedOf(atlas: AtlasDetail): Mapped {
  const measures = atlas.measures.map(({ measure, unit, description }) => ({ name: measure, kind: "float", unit, description }));
  return {
    name: "the atlas",
    axes: [gridAxis(atlas.x), gridAxis(atlas.y)],
    columns: [
      { name: "outcome", kind: "str", unit: "1", description: "The most frequent outcome" },
      { name: CAGED_SHARE, kind: "float", unit: "1", description: "Part of the futures that end in a cage" },
      ...measures,
    ] as Mapped["columns"],
    progress: atlas.progress,
  };
}

/** The number by which the map knows a cell: the last axis fastest. */
export const numberOf = ({ y }: AtlasDetail, cell: Pick<AtlasCell, "x" | "y">): number => cell.x * y.values.length + cell.y;

/** Its places on both axes. */
export const placeOf = ({ y }: AtlasDetail, number: number): { readonly x: number; readonly y: number } => ({ x: Math.floor(number / y.values.length), y: number % y.values.length });

const rowOf = (cell: AtlasCell): StudyRow => ({
  error: cell.error,
  outcome: cell.outcome,
  odds: cell.odds,
  futures: cell.futures,
  caged: cell.caged,
  [CAGED_SHARE]: cell.futures === 0 ? null : cell.caged / cell.futures,
  ...cell.measures,
});

export const rowsOf = (atlas: AtlasDetail, cells: ReadonlyMap<number, AtlasCell>): Rows => new Map([...cells].map(([, cell]) => [numberOf(atlas, cell), rowOf(cell)]));

/** What is least sure is still seen. */
const FAINTEST = 0.25;

/** Of an outcome how many of the futures have it; of a measure how many are caged. */
export const surenessBy =
  (column: string) =>
  (row: StudyRow): number => {
    const share = column === "outcome" ? row["odds"] : row[CAGED_SHARE];
    return FAINTEST + (1 - FAINTEST) * (typeof share === "number" ? share : 1);
  };

/** A few futures a cell differ by chance: colours span no less than this part of a measure. */
const LEAST_SPAN = 0.1;

/** What the colours of a column span; null where it has no numbers. */
export function spanOf(rows: Rows, column: string): readonly [number, number] | null {
  if (column === CAGED_SHARE) return [0, 1];
  const range = rangeOf(rows.values(), column);
  if (range === null) return null;
  const [low, high] = range;
  const lacking = LEAST_SPAN * Math.max(Math.abs(low), Math.abs(high)) - (high - low);
  return lacking <= 0 ? range : [low - lacking / 2, high + lacking / 2];
}

/** What more is said of a cell. */
export function detailOf(row: StudyRow): string {
  if (typeof row["error"] === "string") return row["error"];
  return `${String(row["caged"])} of ${String(row["futures"])} futures caged`;
}

/** Where a value lies between the first value of an axis and the last, in places; null beyond them. */
export function placeOn({ values, present }: Axis): number | null {
  const [first = 0, last = 0] = [values[0], values.at(-1)];
  const place = ((present - first) / (last - first)) * (values.length - 1);
  return Number.isFinite(place) && place >= -0.5 && place <= values.length - 0.5 ? place : null;
}

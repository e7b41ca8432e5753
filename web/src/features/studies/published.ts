/** The paper's tables, by the values of a map's axes. */
import type { PublishedTables, StudyDetail } from "../../api/types";
import type { Spread, Value } from "./layout";

export interface PublishedClasses {
  readonly names: ReadonlySet<string>;
  readonly has: (facet: Value | null) => boolean;
  readonly at: (facet: Value | null, x: Value | null, y: Value | null) => string | null;
}

const key = (...values: (Value | null)[]): string => values.join(" ");

/** The tables laid out as the map is; null if its axes are not those of the paper. */
export function publishedFor(tables: PublishedTables, study: StudyDetail, spread: Spread): PublishedClasses | null {
  const paths = [spread.facet?.path, spread.x.path, spread.y?.path];
  if (study.agreement === null || paths.some((path) => path === undefined || !tables.paths.includes(path))) return null;
  const numbers = ["mass", "damping", "stiffness"] as const;
  const fields = paths.map((path) => numbers[tables.paths.indexOf(path ?? "")] ?? "mass");
  const classes = new Map<string, string>();
  const facets = new Set<Value>();
  for (const cell of tables.cells) {
    const [facet, x, y] = fields.map((field) => cell[field]);
    classes.set(key(facet ?? null, x ?? null, y ?? null), cell.outcome);
    if (facet !== undefined) facets.add(facet);
  }
  return {
    names: new Set(classes.values()),
    has: (facet) => facet !== null && facets.has(facet),
    at: (...values) => classes.get(key(...values)) ?? null,
  };
}

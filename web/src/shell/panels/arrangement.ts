/** In which column of the mission page each of its smaller panels stands, and in which order. */

/** From the left; in the middle they stand below scene and plots. */
export const COLUMNS = ["act", "see", "know"] as const;
export type Column = (typeof COLUMNS)[number];

const USUALLY = {
  act: ["commands", "parameters"],
  see: [],
  know: ["outcome", "problems", "rehearsal", "events"],
} as const;

export type PanelName = (typeof USUALLY)[Column][number];

export type Arrangement = Readonly<Record<Column, readonly PanelName[]>>;

export const USUAL: Arrangement = USUALLY;

export const PANEL_NAMES: readonly PanelName[] = COLUMNS.flatMap((column) => USUAL[column]);

export const PANEL_LABELS: Readonly<Record<PanelName, string>> = {
  commands: "Commands",
  parameters: "Parameters",
  outcome: "Outcome",
  problems: "Problems",
  rehearsal: "Rehearsal",
  events: "Events",
};

const NOTHING = "-";

/** As it is kept and shared: `commands.parameters_-_outcome.problems.rehearsal.events`. */
export const textOf = (arrangement: Arrangement): string => COLUMNS.map((column) => arrangement[column].join(".") || NOTHING).join("_");

/** Whatever a text says of it: every panel once, those that it does not name where they usually are. */
export function arrangementOf(text: string): Arrangement {
  const asked = text.split("_").map((part) => part.split(".").flatMap((name) => PANEL_NAMES.filter((known) => known === name)));
  const seen = new Set<PanelName>();
  const first = (names: readonly PanelName[]): PanelName[] => names.filter((name) => !seen.has(name) && seen.add(name));
  const [act = [], see = [], know = []] = asked.map(first);
  const missing = (column: Column): PanelName[] => USUAL[column].filter((name) => !seen.has(name));
  return { act: [...act, ...missing("act")], see: [...see, ...missing("see")], know: [...know, ...missing("know")] };
}

export interface Place {
  readonly column: Column;
  /** Among the others of that column. */
  readonly at: number;
}

export function placeOf(arrangement: Arrangement, name: PanelName): Place {
  const column = COLUMNS.find((each) => arrangement[each].includes(name)) ?? "know";
  return { column, at: arrangement[column].indexOf(name) };
}

/** With that panel at that place. */
export function moved(arrangement: Arrangement, name: PanelName, { column, at }: Place): Arrangement {
  const without = (of: Column): PanelName[] => arrangement[of].filter((each) => each !== name);
  const target = without(column);
  target.splice(Math.max(0, at), 0, name);
  return { act: without("act"), see: without("see"), know: without("know"), [column]: target };
}

const STEPS: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Where a press of an arrow moves a panel; null where it does not, or at an edge. */
export function steppedTo(arrangement: Arrangement, name: PanelName, key: string): Place | null {
  const step = STEPS[key];
  if (step === undefined) return null;
  const { column, at } = placeOf(arrangement, name);
  const next = COLUMNS[COLUMNS.indexOf(column) + step[0]];
  if (next === undefined) return null;
  if (next !== column) return { column: next, at: Math.min(at, arrangement[next].length) };
  const place = at + step[1];
  return place < 0 || place >= arrangement[column].length ? null : { column, at: place };
}

/** What a fit says, as it is shown; knows nothing of React. */
import type { FitDetail, FitResult, RunSummary } from "../../api/types";

export type Fitted = FitResult["parameters"][number];
export type Channel = FitResult["channels"][number];

/** A number with so many digits that count. */
export const digits = (value: number, count = 4): string => {
  const text = Number(value.toPrecision(count)).toString();
  return text.replace("-", "−");
};

/** A number with as many digits as its error leaves sense in, three at least. */
const sharp = (value: number, error: number | null): string => {
  if (error === null || error <= 0 || value === 0) return digits(value);
  return digits(value, Math.min(9, Math.max(3, 2 + Math.floor(Math.log10(Math.abs(value))) - Math.floor(Math.log10(error)))));
};

/** A part of a force: nobody can tell less than a tenth of a millinewton. */
const newtons = (part: number): string => {
  const text = digits(Math.abs(part) < 1e-4 ? 0 : part, 2);
  return text.startsWith("−") ? text : `+${text}`;
};

const unitOf = (unit: string): string => (unit === "1" ? "" : ` ${unit}`);

export interface ValueRow {
  readonly name: string;
  readonly title: string;
  readonly nominal: string;
  /** Null where the run does not tell it. */
  readonly value: string | null;
  readonly interval: string | null;
}

export function valueRow({ name, description, unit, nominal, value, standard_error: error, low, high, told, why_not }: Fitted): ValueRow {
  const known = told && low !== null && high !== null;
  return {
    name: unit === "1" ? name : `${name} [${unit}]`,
    title: why_not ?? `${description}: ${digits(value)}${unitOf(unit)}`,
    nominal: digits(nominal),
    value: known ? sharp(value, error) : null,
    interval: known ? `${sharp(low, error)} to ${sharp(high, error)}` : null,
  };
}

/** A step of the way from what was foretold to what was measured; places are parts of the width. */
export interface MissBar {
  readonly name: string;
  readonly words: string;
  readonly left: number;
  readonly width: number;
  readonly kind: "level" | "more" | "less";
}

/** The miss as a waterfall: nominal, each parameter's part, what is left, measured. */
export function missBars(miss: NonNullable<FitResult["miss"]>): MissBar[] {
  const steps = [...miss.parts.map(({ name, part }) => ({ name, part })), { name: "unexplained", part: miss.unexplained }];
  let level = miss.nominal;
  const spans = steps.map(({ name, part }) => {
    const from = level;
    level += part;
    return { name, part, low: Math.min(from, level), high: Math.max(from, level) };
  });
  const most = Math.max(miss.nominal, miss.measured, ...spans.map(({ high }) => high), 1e-9);
  const whole = (name: string, force: number): MissBar => ({ name, words: `${digits(force, 3)} N`, left: 0, width: force / most, kind: "level" });
  return [
    whole("nominal", miss.nominal),
    ...spans.map(({ name, part, low, high }): MissBar => ({ name, words: `${newtons(part)} N`, left: Math.max(0, low) / most, width: (high - Math.max(0, low)) / most, kind: part < 0 ? "less" : "more" })),
    whole("measured", miss.measured),
  ];
}

/** What is left of a reading, as points within a field of that size, and its band of two deviations. */
export function residualPoints(channel: Channel, width: number, height: number): { readonly points: string; readonly band: readonly [number, number] } {
  const left = channel.measured.map((value, place) => value - (channel.predicted[place] ?? value));
  const most = Math.max(3 * channel.deviation, ...left.map(Math.abs), 1e-12);
  const [first, last] = [channel.time[0] ?? 0, channel.time.at(-1) ?? 1];
  const x = (time: number): number => (width * (time - first)) / Math.max(1e-9, last - first);
  const y = (value: number): number => (height / 2) * (1 - value / most);
  return {
    points: left.map((value, place) => `M${x(channel.time[place] ?? first).toFixed(1)} ${y(value).toFixed(1)}h.1`).join(""),
    band: [y(2 * channel.deviation), y(-2 * channel.deviation)],
  };
}

export const isUnderWay = ({ status }: FitDetail): boolean => status === "queued" || status === "running";

export function statusWords({ status, note, progress }: FitDetail): string {
  if (status === "running") return note === null ? `${Math.round((100 * progress.done) / Math.max(1, progress.total))} %` : `${note}, ${progress.wall_time.toFixed(0)} s`;
  return note === null ? status : `${status}: ${note}`;
}

/** Fields of the uncertainty model as the rehearsal's form has them: text. */
export const uncertaintyTexts = (uncertainty: Readonly<Record<string, number>>): Record<string, string> =>
  Object.fromEntries(Object.entries(uncertainty).map(([name, value]) => [name, Number(value.toPrecision(3)).toString()]));

/** What another run is to a fit. */
export type Role = "fitted" | "held out";
export type Roles = ReadonlyMap<string, Role>;

/** The service takes eight to fit, this page's among them, and eight held out. */
export const MOST_RUNS: Readonly<Record<Role, number>> = { fitted: 7, "held out": 8 };

/** The roles with another one for that run; null: none. */
export function withRole(roles: Roles, id: string, role: Role | null): Roles {
  const next = new Map(roles);
  if (role === null) next.delete(id);
  else next.set(id, role);
  return next;
}

export const runsOf = (roles: Roles, role: Role): string[] => [...roles].filter(([, each]) => each === role).map(([id]) => id);

/** A run in a list: what it is called, else the end of its identifier, and what tells it from its neighbours. */
export const runWords = ({ id, name, configuration, seed }: Pick<RunSummary, "id" | "name" | "configuration" | "seed">): string =>
  `${name === "" ? `…${id.slice(-6)}` : name}, ${configuration}, seed ${seed}`;

export interface PeakRow {
  readonly key: string;
  readonly words: string;
  readonly heldOut: boolean;
  readonly measured: number;
  readonly nominal: number;
  readonly fitted: number;
}

/** Peak forces of all touches, fitted runs first; a run is named where there is more than one. */
export function peakRows({ runs, held_out: heldOut, touch_predictions: fitted, held_out_predictions: foretold }: FitResult): PeakRow[] {
  const several = runs.length + heldOut.length > 1;
  const row = ({ run, time, arm, measured, nominal, fitted: value }: FitResult["touch_predictions"][number], isHeldOut: boolean): PeakRow => ({
    key: `${run} ${time} ${String(isHeldOut)}`,
    words: `${several ? `…${run.slice(-6)}, ` : ""}${time.toFixed(2)} s, ${arm}`,
    heldOut: isHeldOut,
    measured,
    nominal,
    fitted: value,
  });
  return [...fitted.map((each) => row(each, false)), ...foretold.map((each) => row(each, true))];
}

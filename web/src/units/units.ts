/** The one place where SI and radians become what a person reads. */

export type AngleUnit = "rad" | "deg";

/** How a quantity is shown: SI value times `factor`, in `unit`. */
export interface Shown {
  readonly factor: number;
  readonly unit: string;
}

const DEGREES = 180 / Math.PI;

const TYPESET: Readonly<Record<string, string>> = {
  "1": "",
  "kg m2": "kg·m²",
  "N s/m": "N·s/m",
  "N m": "N·m",
  "N m s": "N·m·s",
  "N s": "N·s",
  m2: "m²",
  "1/s2": "1/s²",
};

/** The unit of the configuration or telemetry as a person prefers to read it. */
export function shown(unit: string, angles: AngleUnit): Shown {
  if (angles === "deg" && unit === "rad") return { factor: DEGREES, unit: "°" };
  if (angles === "deg" && unit === "rad/s") return { factor: DEGREES, unit: "°/s" };
  return { factor: 1, unit: TYPESET[unit] ?? unit };
}

/** Lengths and speeds of a capture are read in millimetres. */
export const MILLIMETRES: Shown = { factor: 1000, unit: "mm" };
export const MILLIMETRES_PER_SECOND: Shown = { factor: 1000, unit: "mm/s" };

const MINUS = "\u2212";

/** A number with a fixed count of decimals, a true minus sign, and never "−0.00". */
export function fixed(value: number, decimals: number): string {
  if (!Number.isFinite(value)) return "—";
  const digits = value.toFixed(decimals);
  if (!digits.startsWith("-")) return digits;
  return Number(digits) === 0 ? digits.slice(1) : MINUS + digits.slice(1);
}

const MOST_DECIMALS = 6;

/** As many decimals as tell neighbouring ticks of an axis apart, and say each as it is. */
export function decimalsOf(ticks: readonly number[]): number {
  const step = Math.abs((ticks[1] ?? 1) - (ticks[0] ?? 0));
  let decimals = 0;
  while (decimals < MOST_DECIMALS && Math.abs(step - Number(step.toFixed(decimals))) > 1e-9) decimals += 1;
  return decimals;
}

/** A number as short as it can be without losing what a person typed. */
export function plain(value: number): string {
  const rounded = Number(value.toPrecision(7));
  const size = Math.abs(rounded);
  return size !== 0 && (size < 1e-3 || size >= 1e6) ? exponential(rounded) : String(rounded);
}

const exponential = (value: number): string => value.toExponential().replace("e+", "e");

/** How long something took or takes: `12.3 s`, from a minute on `1 min 23.4 s`, from an hour on `1 h 5 min`. A moment is shown by `clock`. */
export function duration(seconds: number, decimals = 1): string {
  if (!Number.isFinite(seconds)) return "—";
  const unit = 10 ** decimals;
  // Rounded once, so that 59.96 s reads 1 min 0.0 s and not 60.0 s.
  const total = Math.round(Math.max(0, seconds) * unit) / unit;
  const minutes = Math.floor(total / 60);
  if (minutes >= 60) return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
  const rest = `${(total - 60 * minutes).toFixed(decimals)} s`;
  return minutes > 0 ? `${minutes} min ${rest}` : rest;
}

/** A moment of a mission as minutes and seconds, `01:23.456`. How long something takes is shown by `duration`. */
export function clock(seconds: number, decimals = 3): string {
  const unit = 10 ** decimals;
  // Rounded once, so that 59.9996 s reads 01:00.000 and not 00:60.000.
  const total = Math.round(Math.max(0, seconds) * unit);
  const minutes = Math.floor(total / (60 * unit));
  const rest = (total - minutes * 60 * unit) / unit;
  const width = decimals > 0 ? 3 + decimals : 2;
  return `${String(minutes).padStart(2, "0")}:${rest.toFixed(decimals).padStart(width, "0")}`;
}

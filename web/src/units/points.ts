/** How a list of points is written and read: `0, 0; 0.2, 0; 0, 0.1`, one a line, or in the brackets of JSON.

    The command line reads by the same grammar (`becalm/typed.py`); `points.cases.json` holds both to it. */
import { plainly, readNumber } from "./numbers";
import { plain } from "./units";

/** Each of two coordinates, x and y. */
export type Points = readonly (readonly number[])[];

export type PointsRead = { readonly points: Points } | { readonly error: string };

export const isPoints = (value: unknown): value is Points =>
  Array.isArray(value) && value.every((point) => Array.isArray(point) && point.length === 2 && point.every((each) => typeof each === "number"));

/** Points as they stand in a field, each coordinate times `factor`. */
export const pointsText = (points: Points, factor = 1): string => points.map((point) => point.map((each) => plain(each * factor)).join(", ")).join("; ");

/** The points, or in words what to write instead. */
export function readPoints(typed: string): PointsRead {
  const text = plainly(typed);
  const bare = text.startsWith("[") ? text.replace(/\]\s*,\s*\[/g, ";").replace(/[[\]]/g, " ") : text;
  const written = bare.split(/[;\n]/).map((point) => point.trim()).filter(Boolean);
  if (written.length === 0) return { error: "points are missing; write them as 0, 0; 0.2, 0; 0, 0.1" };
  const points: number[][] = [];
  for (const [place, point] of written.entries()) {
    const [x, y, ...more] = point.split(/\s*,\s*|\s+/).map(readNumber);
    if (x === undefined || y === undefined || more.length > 0) return { error: `point ${place + 1}, "${point}", is not two numbers; write x and y, such as 0.2, 0.1` };
    if ("error" in x) return { error: `point ${place + 1}: ${x.error}` };
    if ("error" in y) return { error: `point ${place + 1}: ${y.error}` };
    points.push([x.value, y.value]);
  }
  return { points };
}

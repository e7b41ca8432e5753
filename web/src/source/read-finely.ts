import type { readTicks } from "../api/service";
import { samplesOfTable, type Sample } from "./quantities";
import type { Range } from "./source";

/** Rows for a stretch: two for each column of pixels of the widest screens. */
export const POINTS = 4000;

/** A stretch of a run on disk in at most `POINTS` rows, the extremes of each piece of time among them. @throws Refusal */
export const readFinely = async (read: typeof readTicks, run: string, range: Range): Promise<Sample[]> =>
  samplesOfTable(await read(run, POINTS, range));

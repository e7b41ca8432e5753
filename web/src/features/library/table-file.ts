/** Runs as files to take away: a table of what the list shows, and the logs of all in one archive. */
import { Zip, ZipPassThrough } from "fflate";
import { Refusal, noAnswer } from "../../api/refusal";
import { logAddress } from "../../api/service";
import type { RunSummary } from "../../api/types";
import { csvCell } from "../../ui/export/csv";
import { isPoints, pointsText } from "../../units/points";

const COLUMNS: readonly (readonly [string, (run: RunSummary) => unknown])[] = [
  ["id", ({ id }) => id],
  ["started", ({ started }) => started],
  ["name", ({ name }) => name],
  ["tags", ({ tags }) => tags.join("; ")],
  ["kind", ({ kind }) => kind],
  ["status", ({ status }) => status],
  ["configuration", ({ configuration }) => configuration],
  ["direct", ({ direct }) => direct],
  ["simulation.engine", ({ engine }) => engine],
  ["simulation.seed", ({ seed }) => seed],
  ["target.initial_spin", (run) => run.initial_spin],
  ["duration", ({ duration }) => duration],
  ["outcome", ({ outcome }) => outcome?.outcome],
  ["at_first_closure", ({ outcome }) => outcome?.at_first_closure],
  ["caged", ({ outcome }) => outcome?.caged],
  ["cage_margin", ({ outcome }) => outcome?.cage_margin],
  ["peak_tip_force", ({ outcome }) => outcome?.peak_tip_force],
  ["peak_tip_force_to_closure", ({ outcome }) => outcome?.peak_tip_force_to_closure],
  ["closed_at", ({ outcome }) => outcome?.closed_at],
  ["touches", ({ outcome }) => outcome?.contacts.length],
  ["final_target_spin", ({ outcome }) => outcome?.final_target_spin],
  ["min_manipulability", ({ outcome }) => outcome?.min_manipulability],
  ["momentum_error", ({ outcome }) => outcome?.momentum_error],
];

const written = (value: unknown): string | number | boolean => (value === null || value === undefined ? "" : isPoints(value) ? pointsText(value) : typeof value === "object" ? JSON.stringify(value) : (value as string | number | boolean));

/** A row for each run, in SI; a column for each parameter that one of them changed, under its full path. */
export function runsAsCsv(runs: readonly RunSummary[]): string {
  const paths = [...new Set(runs.flatMap(({ changes }) => changes.map(({ path }) => path)))].filter((path) => !COLUMNS.some(([name]) => name === path)).sort();
  const head = [...COLUMNS.map(([name]) => name), ...paths];
  const rows = runs.map((run) => [...COLUMNS.map(([, read]) => read(run)), ...paths.map((path) => run.changes.find((change) => change.path === path)?.value)]);
  return [head, ...rows].map((row) => row.map((value) => csvCell(written(value))).join(",")).join("\r\n") + "\r\n";
}

export type LogFormat = Parameters<typeof logAddress>[1];

/** @throws Refusal */
async function readLog(id: string, format: LogFormat): Promise<Uint8Array> {
  let answer: Response;
  try {
    answer = await fetch(logAddress(id, format));
  } catch (cause) {
    throw noAnswer(cause);
  }
  if (!answer.ok) throw new Refusal(answer.status, "The log was refused", `The log of run ${id} was answered with ${answer.status}.`, "", []);
  return new Uint8Array(await answer.arrayBuffer());
}

/** The logs one after another, so that a service that flies is not asked for all at once, in one archive. @throws Refusal */
export async function logsAsZip(ids: readonly string[], format: LogFormat, progress: (read: number) => void): Promise<Blob> {
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  const archive = new Zip((cause, piece) => {
    if (cause !== null) throw cause;
    pieces.push(piece);
  });
  for (const [place, id] of ids.entries()) {
    // As they are: compressing would hold the page up, and MCAP and Parquet are compressed already.
    const file = new ZipPassThrough(`becalm-${id}.${format}`);
    archive.add(file);
    file.push(await readLog(id, format), true);
    progress(place + 1);
  }
  archive.end();
  return new Blob(pieces, { type: "application/zip" });
}

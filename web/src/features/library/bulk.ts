/** One request for each of many runs: a few at a time, as far as each is allowed. */
import { Refusal } from "../../api/refusal";

/** So many requests are under way at once: a service that flies has other things to do. */
const AT_ONCE = 4;

export interface BulkResult {
  readonly done: number;
  readonly refused: readonly { readonly id: string; readonly why: string }[];
}

/** @param progress is told how many have been answered. */
export async function forEachRun(ids: readonly string[], work: (id: string) => Promise<unknown>, progress: (answered: number) => void): Promise<BulkResult> {
  const waiting = [...ids];
  const refused: { id: string; why: string }[] = [];
  let answered = 0;
  const worker = async (): Promise<void> => {
    for (let id = waiting.shift(); id !== undefined; id = waiting.shift()) {
      try {
        await work(id);
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        refused.push({ id, why: cause.message });
      }
      answered += 1;
      progress(answered);
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, worker));
  return { done: ids.length - refused.length, refused };
}

/** Such as "12 runs deleted; 1 was refused: run A is the live mission". */
export function resultWords({ done, refused }: BulkResult, what: string): string {
  const words = `${done} ${done === 1 ? "run" : "runs"} ${what}`;
  const [first] = refused;
  if (first === undefined) return `${words}.`;
  return `${words}; ${refused.length} ${refused.length === 1 ? "was" : "were"} refused: ${first.why}`;
}

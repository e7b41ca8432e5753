/** What the last rehearsal of a run predicted, as plots draw it. */
import type { RehearsalResult } from "../../api/types";
import type { Config } from "../../source/source";
import { valueAt } from "../parameters/draft";
import { bandsOf, type Prediction } from "../plots/prediction";
import { CASE_WORDS, type CaseName } from "./words";

/** The case that flies: as changed once all the changes are in force. */
export function caseInForce(result: RehearsalResult, config: Config | null): CaseName {
  const changes = Object.entries(result.changes);
  if (result.as_changed === null || changes.length === 0) return "as_it_is";
  return changes.every(([path, to]) => JSON.stringify(valueAt(config, path)) === JSON.stringify(to)) ? "as_changed" : "as_it_is";
}

/** What was predicted of a mission that flies with this configuration. */
export function predictionOf(result: RehearsalResult, config: Config | null, dismiss: (() => void) | null): Prediction {
  const name = caseInForce(result, config);
  const { fans } = result[name] ?? result.as_it_is;
  return {
    words: CASE_WORDS[name].toLowerCase(),
    from: result.time,
    requested: result.request !== null,
    bands: bandsOf(fans),
    dismiss,
  };
}

/** What a new mission in place of the present one would end or undo. */
import type { MissionSnapshot } from "../../api/types";
import { useSnapshot } from "../../store/context";

/** In a sentence or two; null if nothing is lost. */
export function whatIsLost({ phase, activity, configuration }: Pick<MissionSnapshot, "phase" | "activity" | "configuration">): string | null {
  const flying = phase === "detumbling" || phase === "caging" || activity !== "none";
  const losses = [
    flying ? "The mission in progress will end." : null,
    configuration.endsWith(" (edited)") ? "Edited parameters will be lost unless they are saved as a preset." : null,
  ].filter((loss) => loss !== null);
  return losses.length === 0 ? null : losses.join(" ");
}

export const useWhatIsLost = (): string | null => useSnapshot(whatIsLost);

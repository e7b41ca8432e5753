/** Go or no-go for the request that would come next, as the service foresees it; asked while somebody looks. */
import { useQuery } from "@tanstack/react-query";
import { readLookAhead } from "../../api/service";
import type { Command, LookAhead, MissionSnapshot } from "../../api/types";
import type { Trust } from "../../store/mission";
import { useView } from "../../store/context";
import { useRoute } from "../../store/route";

/** Milliseconds between two looks. */
const LOOK_PERIOD = 2000;

/** Whether a capture could be asked for: only then is there something to look ahead to. */
export const mayLookAhead = (trust: Trust, snapshot: Pick<MissionSnapshot, "commands"> | null): boolean =>
  trust === "live" && snapshot !== null && (snapshot.commands["capture"] ?? null) === null;

/** Null while nobody looks, nothing could be asked for, or the service says nothing. */
export function useLookAhead(): LookAhead | null {
  const { page } = useRoute();
  const wanted = useView((view) => mayLookAhead(view.trust, view.snapshot)) && page === "mission";
  const { data, isError } = useQuery({
    queryKey: ["look-ahead"],
    queryFn: readLookAhead,
    enabled: wanted,
    // A page in the background is not looked at.
    refetchInterval: LOOK_PERIOD,
    gcTime: 0,
  });
  return wanted && !isError ? (data ?? null) : null;
}

/** What a command that is foreseen to end badly is warned with; null for every other. */
export function noGoOf(ahead: LookAhead | null, command: Command): string | null {
  if (ahead?.made !== true || ahead.go !== false || ahead.request !== command) return null;
  return `No go: ${ahead.reason ?? ahead.words}.`;
}

export interface LineWords {
  readonly verdict: "go" | "no-go" | "unknown";
  readonly words: string;
}

/** The line beside the commands; nothing is in the way where nothing is foreseen. */
export function lineOf(ahead: LookAhead | null): LineWords {
  if (ahead === null) return { verdict: "unknown", words: "No look-ahead: nothing can begin now." };
  if (!ahead.made) return { verdict: "unknown", words: `No look-ahead: ${ahead.reason ?? "none was made"}.` };
  return { verdict: ahead.go === true ? "go" : "no-go", words: ahead.words };
}

/** The edits that are staged, kept above the pages: what else proposes values stages them like edits of the form. */
import { createContext, useContext, useEffect, useMemo, useState, type Dispatch, type SetStateAction } from "react";
import { useConfiguration } from "../../store/configuration";
import { usePreferences } from "../../units/preferences";
import { keep, readKept } from "../../ui/use-kept-json";
import { changesOf, draftWith, readDraft, unsoundFields, type Change, type Draft, type Value } from "./draft";

export interface Staging {
  readonly draft: Draft;
  readonly setDraft: Dispatch<SetStateAction<Draft>>;
  /** The sound edits that differ from what is in force. */
  readonly changes: readonly Change[];
  /** How many fields hold what cannot be sent. */
  readonly unsound: number;
  /** Puts values, by full path and in SI, beside whatever else is staged. */
  readonly stageValues: (values: Readonly<Record<string, Value>>) => void;
}

export const StagingContext = createContext<Staging>({ draft: {}, setDraft: () => undefined, changes: [], unsound: 0, stageValues: () => undefined });

export const useStaging = (): Staging => useContext(StagingContext);

/** A reload keeps what was typed, in this tab. */
const KEPT = "becalm-staged";

/** Of the live mission. */
export function useStagingState(): Staging {
  const { parameters, inForce } = useConfiguration();
  const { angles } = usePreferences();
  const [draft, setDraft] = useState<Draft>(() => readKept(KEPT, readDraft, "tab"));
  useEffect(() => {
    keep(KEPT, draft, "tab");
  }, [draft]);
  return useMemo(
    () => ({
      draft,
      setDraft,
      changes: changesOf(draft, parameters, inForce?.config),
      unsound: unsoundFields(draft, parameters).length,
      stageValues: (values) => {
        setDraft((old) => draftWith(old, values, parameters, inForce?.config, angles));
      },
    }),
    [draft, parameters, inForce, angles],
  );
}

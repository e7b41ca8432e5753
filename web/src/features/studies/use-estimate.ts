/** How large a study would be and how long it would take, asked of the service while its form is filled in. */
import { useEffect, useState } from "react";
import { Refusal } from "../../api/refusal";
import { estimateStudy } from "../../api/service";
import type { StudyEstimate, StudyRequest } from "../../api/types";

/** Milliseconds without a key pressed until the service is asked. */
const SETTLED = 500;
/** Milliseconds between two looks while the time is measured. */
const MEASURING_PERIOD = 1000;
/** Milliseconds for which a measured time is shown before it is asked for again: the machine's load changes. */
const FRESH = 60_000;

export interface EstimateView {
  readonly estimate: StudyEstimate | null;
  readonly refusal: Refusal | null;
}

const NOTHING: EstimateView = { estimate: null, refusal: null };

/** Of the request while it is wanted; null for none. */
export function useEstimate(request: StudyRequest | null): EstimateView {
  const asked = request === null ? null : JSON.stringify(request);
  const [view, setView] = useState<EstimateView & { readonly of: string | null }>({ ...NOTHING, of: null });
  useEffect(() => {
    if (asked === null) return undefined;
    let wanted = true;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const look = async (): Promise<void> => {
      let next = FRESH;
      try {
        const estimate = await estimateStudy(JSON.parse(asked) as StudyRequest);
        if (wanted) setView({ estimate, refusal: null, of: asked });
        if (estimate.measuring) next = MEASURING_PERIOD;
      } catch (cause) {
        if (!(cause instanceof Refusal)) throw cause;
        if (wanted) setView({ estimate: null, refusal: cause, of: asked });
      }
      if (wanted) timer = setTimeout(() => void look(), next);
    };
    timer = setTimeout(() => void look(), SETTLED);
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [asked]);
  // What was said of another request is not said of this one.
  return view.of === asked ? view : NOTHING;
}

/** How large a study would be and how long it would take, asked of the service while its form is filled in. */
import { useDebouncedValue } from "@mantine/hooks";
import { skipToken, useQuery } from "@tanstack/react-query";
import { refusalIn } from "../../api/query-client";
import type { Refusal } from "../../api/refusal";
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

/** Of the request while it is wanted; null for none. */
export function useEstimate(request: StudyRequest | null): EstimateView {
  const wanted = request === null ? null : JSON.stringify(request);
  const [asked] = useDebouncedValue(wanted, SETTLED);
  const settled = asked === wanted ? asked : null;
  const { data, error } = useQuery({
    queryKey: ["estimate", settled],
    queryFn: settled === null ? skipToken : () => estimateStudy(JSON.parse(settled) as StudyRequest),
    staleTime: MEASURING_PERIOD,
    refetchInterval: ({ state }) => (state.data?.measuring === true ? MEASURING_PERIOD : FRESH),
  });
  return { estimate: data ?? null, refusal: refusalIn(error) };
}

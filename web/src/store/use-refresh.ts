/** Has a source tell more, as often as there may be more. */
import { useQuery } from "@tanstack/react-query";
import { useId } from "react";
import type { MissionStore } from "./mission";

/** While `wanted` says so, asked each time; null has no source. */
export function useRefresh(store: MissionStore | null, wanted: () => boolean = () => true): void {
  const hook = useId();
  useQuery({
    queryKey: ["refresh", hook],
    queryFn: async () => {
      if (store !== null && wanted()) await store.source.refresh();
      return null;
    },
    // Opening a source has told what there is.
    initialData: null,
    staleTime: Infinity,
    refetchInterval: () => store?.source.refreshPeriod ?? false,
  });
}

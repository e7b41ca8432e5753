/** The link as the service knows it, asked for again and again while the page is shown. */
import { useQuery } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { refusalIn } from "../../api/query-client";
import type { Refusal } from "../../api/refusal";
import { readLink } from "../../api/service";
import type { LinkStatus } from "../../api/types";

/** Milliseconds between two questions. */
const PERIOD = 400;
/** Milliseconds without an answer after which what is shown counts as old. */
const OLD_AFTER = 900;

export interface LinkView {
  readonly link: LinkStatus | null;
  /** The service has not answered for a while. */
  readonly old: boolean;
  readonly refusal: Refusal | null;
}

/** Whether nothing new has come for a while, `at` being the time of the latest answer. */
function useOld(at: number, shown: boolean): boolean {
  const [oldAt, setOldAt] = useState<number | null>(null);
  useEffect(() => {
    if (!shown) return undefined;
    const timer = setTimeout(() => {
      setOldAt(at);
    }, OLD_AFTER);
    return () => {
      clearTimeout(timer);
      setOldAt(null);
    };
  }, [at, shown]);
  return oldAt === at;
}

export function useLink(shown: boolean): LinkView {
  const { data, error, dataUpdatedAt } = useQuery({
    queryKey: ["link"],
    queryFn: readLink,
    enabled: shown,
    refetchInterval: PERIOD,
    refetchIntervalInBackground: true,
  });
  return { link: data ?? null, old: useOld(dataUpdatedAt, shown), refusal: refusalIn(error) };
}

/** How the page asks the service again and again: TanStack Query, except for telemetry and STOP, which do not depend on it. */
import { QueryCache, QueryClient } from "@tanstack/react-query";
import { Refusal } from "./refusal";

export const newQueryClient = (): QueryClient =>
  new QueryClient({
    queryCache: new QueryCache({
      // What the service refuses is shown where it was asked; anything else is a fault of the page.
      onError: (cause) => {
        if (!(cause instanceof Refusal)) reportError(cause);
      },
    }),
    defaultOptions: {
      queries: {
        // The service may run on this computer, which then needs no network.
        networkMode: "always",
        // What is looked at is asked for again anyway; a failure is shown at once.
        retry: false,
      },
    },
  });

/** The refusal among errors; null for none. */
export const refusalIn = (cause: Error | null): Refusal | null => (cause instanceof Refusal ? cause : null);

/** Who uses this page, and what they may do. */
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { createContext, useContext } from "react";
import { readSession } from "../../api/service";
import type { Role, Session } from "../../api/types";

/** Milliseconds between two looks whether the token still holds. */
const CHECK_PERIOD = 5000;

const SESSION = ["session"];

const ORDER: readonly Role[] = ["viewer", "operator", "admin"];

export interface Access {
  /** Null until the service has said so. */
  readonly session: Session | null;
  readonly setSession: (session: Session) => void;
}

export const AccessContext = createContext<Access>({ session: null, setSession: () => undefined });

/** Asks who one is, and goes on asking where a token may be revoked; a service that does not answer changes nothing. */
export function useAccessState(): Access {
  const client = useQueryClient();
  const { data } = useQuery({
    queryKey: SESSION,
    queryFn: readSession,
    refetchInterval: ({ state }) => (state.data?.token_needed === false ? false : CHECK_PERIOD),
    refetchIntervalInBackground: true,
  });
  return {
    session: data ?? null,
    setSession: (session) => {
      client.setQueryData(SESSION, session);
    },
  };
}

export const useAccess = (): Access => useContext(AccessContext);

/** Why a person may not do what takes that role; null if they may. */
export function reasonByRole(session: Session | null, needed: Role): string | null {
  const role = session?.role ?? null;
  if (session?.token_needed === false || (role !== null && ORDER.indexOf(role) >= ORDER.indexOf(needed))) return null;
  return role === null ? "You are not signed in." : `You are signed in as ${role}; this requires the role ${needed}.`;
}

export const useReasonByRole = (needed: Role): string | null => reasonByRole(useAccess().session, needed);

/** Who uses this page, and what they may do. */
import { createContext, useCallback, useContext, useEffect, useState } from "react";
import { readSession } from "../../api/service";
import type { Role, Session } from "../../api/types";

/** Milliseconds between two looks whether the token still holds. */
const LOOK_PERIOD = 5000;

const ORDER: readonly Role[] = ["viewer", "operator", "admin"];

export interface Access {
  /** Null until the service has said so. */
  readonly session: Session | null;
  readonly setSession: (session: Session) => void;
}

export const AccessContext = createContext<Access>({ session: null, setSession: () => undefined });

/** Asks who one is, and goes on asking where a token may be revoked; a service that does not answer changes nothing. */
export function useAccessState(): Access {
  const [session, setSession] = useState<Session | null>(null);
  const look = useCallback(() => {
    readSession().then(setSession, () => undefined);
  }, []);
  const settled = session?.token_needed === false;
  useEffect(() => {
    look();
    if (settled) return undefined;
    const timer = setInterval(look, LOOK_PERIOD);
    return () => {
      clearInterval(timer);
    };
  }, [look, settled]);
  return { session, setSession };
}

export const useAccess = (): Access => useContext(AccessContext);

/** Why a person may not do what takes that role; null if they may. */
export function reasonByRole(session: Session | null, needed: Role): string | null {
  const role = session?.role ?? null;
  if (session?.token_needed === false || (role !== null && ORDER.indexOf(role) >= ORDER.indexOf(needed))) return null;
  return role === null ? "You are not signed in." : `You are signed in as ${role}; this takes the role ${needed}.`;
}

export const useReasonByRole = (needed: Role): string | null => reasonByRole(useAccess().session, needed);

/** With a robot, changes that take a new mission take two presses: the first has the service arm them. */
import { useEffect, useState } from "react";
import { armCommand } from "../../api/service";
import type { Arming } from "../../api/types";
import { useSnapshot } from "../../store/context";
import { patchOf, type Change } from "./draft";

export interface ArmedChanges {
  readonly arming: Arming;
  /** When it is taken back, on the clock of `performance.now()`. */
  readonly until: number;
}

interface ArmingOfChanges {
  /** These changes, armed; null if they are not, or not any more. */
  readonly armed: ArmedChanges | null;
  /** Arms these changes if they have to be and are not; whether it did. */
  readonly comesFirst: () => Promise<boolean>;
}

export function useArmingOf(changes: readonly Change[]): ArmingOfChanges {
  const byService = useSnapshot((snapshot) => snapshot.arming_needed.includes("configure")) ?? false;
  const [held, setHeld] = useState<(ArmedChanges & { readonly of: string }) | null>(null);
  const present = JSON.stringify(patchOf(changes));
  useEffect(() => {
    if (held === null) return undefined;
    const timer = setTimeout(() => {
      setHeld(null);
    }, held.until - performance.now());
    return () => {
      clearTimeout(timer);
    };
  }, [held]);
  const armed = held?.of === present ? held : null;
  return {
    armed,
    comesFirst: async () => {
      if (!byService || armed !== null || changes.every(({ parameter }) => parameter.live)) return false;
      const arming = await armCommand({ command: "configure", changes: patchOf(changes) });
      setHeld({ arming, until: performance.now() + 1000 * arming.expires_in, of: present });
      return true;
    },
  };
}

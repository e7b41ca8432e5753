/** Who is in control of the mission, as seen by who looks at this page. */
import { useSnapshot } from "../../store/context";
import type { Control, Session } from "../../api/types";
import { reasonByRole, useAccess } from "../access/session";

/** `offered`: somebody else's, and mine to take now. */
export type Hold = "free" | "mine" | "offered" | "others";

export function holdOf(control: Control, me: string | null): Hold {
  if (control.holder === null) return "free";
  if (control.holder === me) return "mine";
  return control.offered_to !== null && control.offered_to === me ? "offered" : "others";
}

export function controlWords(control: Control, me: string | null): string {
  const { holder, offered_to: to } = control;
  const words: Readonly<Record<Hold, string>> = {
    free: "Nobody in control",
    mine: to === null ? "You are in control" : `Offered to ${to}`,
    offered: `${holder ?? ""} hands over to you`,
    others: `${holder ?? ""} is in control`,
  };
  return words[holdOf(control, me)];
}

/** Why a person may not command the mission; null if they may. */
export function reasonByControl(control: Control | null, me: string | null): string | null {
  if (control === null || control.holder === null || control.holder === me) return null;
  return `${control.holder} is in control; take over at the top of the page first.`;
}

export const reasonAgainst = (session: Session | null, control: Control | null): string | null =>
  reasonByRole(session, "operator") ?? reasonByControl(control, session?.name ?? null);

export const useControl = (): Control | null => useSnapshot((snapshot) => snapshot.control);

/** By role and by who is in control. */
export function useReasonAgainstCommanding(): string | null {
  const { session } = useAccess();
  return reasonAgainst(session, useControl());
}

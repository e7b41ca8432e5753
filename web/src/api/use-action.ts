/** A request that a panel makes of the service: whether it is under way, and its refusal. */
import { useState } from "react";
import { Refusal } from "./refusal";

export type RunAction = (work: () => Promise<unknown>) => Promise<void>;

export function useAction(): { readonly runAction: RunAction; readonly waiting: boolean; readonly refusal: Refusal | null } {
  const [waiting, setWaiting] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const runAction: RunAction = async (work) => {
    setWaiting(true);
    setRefusal(null);
    try {
      await work();
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      setRefusal(cause);
    } finally {
      setWaiting(false);
    }
  };
  return { runAction, waiting, refusal };
}

/** Something asked of the service from a panel: whether it is under way, and what the service said against it. */
import { useState } from "react";
import { Refusal } from "./refusal";

export type Doing = (work: () => Promise<unknown>) => Promise<void>;

export function useDoing(): { readonly doing: Doing; readonly waiting: boolean; readonly refusal: Refusal | null } {
  const [waiting, setWaiting] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const doing: Doing = async (work) => {
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
  return { doing, waiting, refusal };
}

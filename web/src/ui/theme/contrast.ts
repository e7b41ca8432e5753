/** Higher contrast than both themes have by themselves: a choice of this browser. */
import { useLayoutEffect } from "react";
import { useShared } from "../use-shared";

export type Contrast = "usual" | "high";

/** A system that asks for more contrast is given it by itself. */
export const CONTRAST = { key: "becalm-contrast", initial: typeof matchMedia === "function" && matchMedia("(prefers-contrast: more)").matches ? "high" : "usual", allowed: ["usual", "high"] } as const;

export function useContrast(): void {
  const [contrast] = useShared<Contrast>(CONTRAST);
  // Before the plots read the colours.
  useLayoutEffect(() => {
    document.documentElement.dataset["contrast"] = contrast;
  }, [contrast]);
}

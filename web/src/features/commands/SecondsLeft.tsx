/** What stands on an armed button: that the next press goes, and for how long it will. */
import { useClock } from "../../ui/use-clock";

/** The look of every button whose next press goes. */
export const ARMED_STYLE = { variant: "filled", color: "yellow", autoContrast: true, "data-armed": true } as const;

const PERIOD = 200;

/** @param until when it is taken back, on the clock of `performance.now()`. */
export function SecondsLeft({ until }: { readonly until: number }) {
  const now = useClock(PERIOD);
  return <>{`Go · ${Math.max(0, Math.ceil((until - now) / 1000))} s`}</>;
}

/** What stands on an armed button: that the next press goes, and for how long it will. */
import { useEffect, useState } from "react";

/** The look of every button whose next press goes. */
export const ARMED_LOOK = { variant: "filled", color: "yellow", autoContrast: true, "data-armed": true } as const;

const PERIOD = 200;

/** @param until when it is taken back, on the clock of `performance.now()`. */
export function SecondsLeft({ until }: { readonly until: number }) {
  const [now, setNow] = useState(() => performance.now());
  useEffect(() => {
    const timer = setInterval(() => {
      setNow(performance.now());
    }, PERIOD);
    return () => {
      clearInterval(timer);
    };
  }, [until]);
  return <>{`Go · ${Math.max(0, Math.ceil((until - now) / 1000))} s`}</>;
}

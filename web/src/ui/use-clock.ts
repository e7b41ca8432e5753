/** The time, for what counts seconds on the screen. */
import { useEffect, useState } from "react";

/** Milliseconds on the clock of `performance.now()`, as often as `period` (milliseconds) says. */
export function useClock(period: number): number {
  const [now, setNow] = useState(() => performance.now());
  useEffect(() => {
    const timer = setInterval(() => {
      setNow(performance.now());
    }, period);
    return () => {
      clearInterval(timer);
    };
  }, [period]);
  return now;
}

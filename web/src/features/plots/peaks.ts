/** When the force of a touch was greatest: the sample nearest to the peak, which was measured tick by tick. */
import type { Touch } from "../../api/types";
import type { Series } from "../../source/series";

export function instantOfPeak(series: Series, touch: Touch): number {
  const quantity = touch.arm === "left" ? "leftForce" : "rightForce";
  const end = Math.min(series.length, series.rowAt(touch.end ?? Infinity) + 1);
  let [instant, greatest] = [touch.start, -Infinity];
  for (let row = series.rowAt(touch.start); row < end; row += 1) {
    const force = series.at(quantity, row);
    if (force > greatest) [instant, greatest] = [series.at("time", row), force];
  }
  return instant;
}

/** The values of a curve in the unit of its axis. */

/** Numbers alone, as long as there is no gap; else null where nothing was recorded: no line is drawn over it. */
export function scaledCurve(values: Float64Array, factor: number): Float64Array | (number | null)[] {
  const scaled = new Float64Array(values.length);
  let whole = true;
  for (let place = 0; place < values.length; place += 1) {
    const value = (values[place] ?? Number.NaN) * factor;
    scaled[place] = value;
    whole &&= Number.isFinite(value);
  }
  return whole ? scaled : Array.from(scaled, (value) => (Number.isFinite(value) ? value : null));
}

/** The target's spin against the threshold below which caging may begin. */
import { usePreferences } from "../../units/preferences";
import { useSnapshot, useStore } from "../../store/context";
import { Icon } from "../../ui/theme/Icon";
import { fixed, shown } from "../../units/units";
import { Cell, Reading, Remark } from "./Cell";
import styles from "./SpinGauge.module.css";

/** The gauge reaches at least to twice the threshold, and to the spin at the start. */
function reach(initial: number, spin: number, threshold: number): number {
  return Math.max(2 * threshold, 1.1 * Math.abs(initial), Math.abs(spin));
}

function Bar({ spin, threshold, full }: { readonly spin: number; readonly threshold: number; readonly full: number }) {
  const mark = (100 * threshold) / full;
  return (
    <>
      <rect className={styles.allowed} x="0" y="2" width={mark} height="4" />
      <rect className={Math.abs(spin) < threshold ? styles.below : styles.above} x="0" y="2" width={(100 * Math.abs(spin)) / full} height="4" />
      <rect className={styles.mark} x={mark - 0.5} y="0" width="1" height="8" />
    </>
  );
}

export function SpinGauge() {
  const { angles } = usePreferences();
  const { series } = useStore();
  const spin = useSnapshot((snapshot) => snapshot.spin);
  const threshold = useSnapshot((snapshot) => snapshot.spin_threshold);
  const { factor, unit } = shown("rad/s", angles);
  const coarse = angles === "deg";
  const known = spin !== null && threshold !== null;
  const below = known && Math.abs(spin) < threshold;
  const without = spin === null ? "no data" : "caged at any spin";
  const limit = known ? `${below ? "below" : "above"} threshold ${fixed(threshold * factor, coarse ? 1 : 2)} ${unit}` : without;
  return (
    <Cell label="Target spin" term="target_spin" width={196}>
      <Reading value={fixed((spin ?? Number.NaN) * factor, coarse ? 1 : 3)} unit={unit} />
      <svg className={styles.gauge} viewBox="0 0 100 8" preserveAspectRatio="none" aria-hidden="true">
        <rect className={styles.track} x="0" y="2" width="100" height="4" />
        {known && <Bar spin={spin} threshold={threshold} full={reach(series.length > 0 ? series.at("spin", 0) : spin, spin, threshold)} />}
      </svg>
      <Remark>
        {below && <Icon icon="check" size={12} />}
        {limit}
      </Remark>
    </Cell>
  );
}

import { memo } from "react";
import type { Touch } from "../../api/types";
import { meaningOf } from "../glossary/glossary";
import { Icon } from "../../ui/theme/Icon";
import { clock, duration, fixed } from "../../units/units";
import styles from "./TouchTable.module.css";

const NAMES = { left: "Left", right: "Right" } as const;

const Row = memo(function Row({ touch }: { readonly touch: Touch }) {
  const lasts = touch.end === null ? "now" : duration(touch.end - touch.start, 2);
  return (
    <tr>
      <td>
        <span className={styles.hand} data-arm={touch.arm}>
          {NAMES[touch.arm].charAt(0)}
        </span>
        {NAMES[touch.arm]}
        {!touch.planned && (
          <span className={styles.unplanned} title={meaningOf("unplanned") ?? undefined}>
            <Icon icon="warning" size={12} />
            <span className="visually-hidden">unplanned</span>
          </span>
        )}
      </td>
      <td>{clock(touch.start, 2)}</td>
      <td>{lasts}</td>
      <td>{fixed(touch.peak, 3)} N</td>
    </tr>
  );
});

/** Every touch so far: which hand, when, how long, how hard. */
export function TouchTable({ touches }: { readonly touches: readonly Touch[] }) {
  if (touches.length === 0) return <p className={styles.none}>No touches yet.</p>;
  return (
    <div className={styles.scroll} tabIndex={0} role="region" aria-label="Touches">
      <table className={styles.table}>
        <thead>
          <tr>
            <th scope="col">{touches.length === 1 ? "1 touch" : `${touches.length} touches`}</th>
            <th scope="col">at</th>
            <th scope="col">for</th>
            <th scope="col">peak</th>
          </tr>
        </thead>
        <tbody>
          {touches.map((touch) => (
            <Row key={`${touch.arm} ${touch.start}`} touch={touch} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

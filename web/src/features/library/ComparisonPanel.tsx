/** Two runs in figures; their plots lie over one another, the second one thinner and paler. */
import { SegmentedControl } from "@mantine/core";
import { Panel } from "../../ui/Panel";
import { hashOf } from "../../store/route";
import type { Run } from "../../api/types";
import { useConfiguration } from "../../store/configuration";
import type { Alignment } from "../plots/compared";
import styles from "./ComparisonPanel.module.css";
import { choices, figures, named, type Line } from "./comparison";

interface ComparisonPanelProps {
  /** The address of this run alone. */
  readonly end: string;
  readonly one: Run;
  readonly other: Run;
  readonly align: Alignment;
  readonly onAlign: (align: Alignment) => void;
}

function Lines({ lines, label }: { readonly lines: readonly Line[]; readonly label: string }) {
  return (
    <tbody>
      <tr>
        <th scope="rowgroup" colSpan={3} className={styles.group}>
          {label}
        </th>
      </tr>
      {lines.map(({ name, path, one, other }) => (
        <tr key={path ?? name} data-same={one === other || undefined}>
          <th scope="row" title={path}>{name}</th>
          <td>{one}</td>
          <td>{other}</td>
        </tr>
      ))}
    </tbody>
  );
}

export function ComparisonPanel({ end, one, other, align, onAlign }: ComparisonPanelProps) {
  const { parameters } = useConfiguration();
  const chosen = named(choices(one, other), parameters);
  return (
    <Panel title="Comparison" aside={<a className={styles.end} href={end}>End comparison</a>}>
      <table className={styles.table}>
        <thead>
          <tr>
            <td />
            <th scope="col">
              <svg width="18" height="8" aria-hidden="true"><line x1="0" y1="4" x2="18" y2="4" stroke="currentColor" strokeWidth="2.5" /></svg>
              This run
            </th>
            <th scope="col">
              <svg width="18" height="8" aria-hidden="true"><line x1="0" y1="4" x2="18" y2="4" stroke="currentColor" strokeWidth="1" opacity="0.6" /></svg>
              <a href={hashOf({ page: "runs", item: other.id, other: one.id })} title="Open this run">{`…${other.id.slice(-6)}`}</a>
            </th>
          </tr>
        </thead>
        <Lines lines={figures(one, other)} label="Results" />
        <Lines lines={chosen} label={chosen.length === 0 ? "No changed parameters" : "Changed parameters"} />
      </table>
      <div className={styles.align}>
        <span>Align at</span>
        <SegmentedControl
          aria-label="Alignment of the two runs"
          value={align}
          data={[
            { value: "motion", label: "first motion" },
            { value: "clock", label: "mission time 0" },
          ]}
          onChange={onAlign}
        />
      </div>
    </Panel>
  );
}

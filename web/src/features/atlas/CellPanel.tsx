/** One cell of the atlas: its values, which are staged, how its futures end, and one of them as a run. */
import { useState } from "react";
import { runAtlasFuture } from "../../api/service";
import type { AtlasCell, AtlasDetail, Run } from "../../api/types";
import { useAction } from "../../api/use-action";
import { hashOf } from "../../store/route";
import { Panel } from "../../ui/Panel";
import { plain, shown } from "../../units/units";
import { RoleButton } from "../access/RoleButton";
import { classStyle } from "../glossary/class-style";
import { Term } from "../glossary/Term";
import { FutureRun } from "../rehearsal/OpenFuture";
import { axisName } from "../studies/geometry";
import styles from "../studies/StudiesPage.module.css";
import own from "./Atlas.module.css";

const figure = (value: number, unit: string): string => `${plain(Number(value.toPrecision(4)))} ${shown(unit, "rad").unit}`.trim();

function Values({ atlas, cell }: { readonly atlas: AtlasDetail; readonly cell: Pick<AtlasCell, "x" | "y"> }) {
  return [
    { axis: atlas.x, place: cell.x },
    { axis: atlas.y, place: cell.y },
  ].map(({ axis, place }) => (
    <div key={axis.path} title={`${axis.path}: ${axis.description}`}>
      <dt>{axisName(axis.path)}</dt>
      <dd>{`${figure(axis.values[place] ?? Number.NaN, axis.unit)}, now ${figure(axis.present, axis.unit)}`}</dd>
    </div>
  ));
}

function Outcomes({ cell }: { readonly cell: AtlasCell }) {
  return Object.entries(cell.outcomes).map(([outcome, count]) => (
    <div key={outcome}>
      <dt>
        <span className={styles.swatch} style={{ background: classStyle(outcome).colour }} aria-hidden="true">
          {classStyle(outcome).letter}
        </span>
        <Term term={outcome}>{classStyle(outcome).words}</Term>
      </dt>
      <dd>{`${count} of ${cell.futures}`}</dd>
    </div>
  ));
}

function Measures({ atlas, cell }: { readonly atlas: AtlasDetail; readonly cell: AtlasCell }) {
  return atlas.measures.map(({ measure, unit, description }) => {
    const value = cell.measures[measure] ?? null;
    return (
      <div key={measure} title={`${description}; median of the futures`}>
        <dt>{measure.replaceAll("_", " ")}</dt>
        <dd>{value === null ? "—" : figure(value, unit)}</dd>
      </div>
    );
  });
}

/** The futures of the cell, each of which may be flown again as a run. */
function Futures({ atlas, cell }: { readonly atlas: AtlasDetail; readonly cell: AtlasCell }) {
  const { runAction, waiting, refusal } = useAction();
  const [run, setRun] = useState<Run | null>(null);
  const fly = (future: number): void =>
    void runAction(async () => {
      setRun(await runAtlasFuture(atlas.id, cell.x, cell.y, future));
    });
  return (
    <div className={own.futures}>
      <h3>Fly one of its futures as a run</h3>
      <div className={own.numbers}>
        {Array.from({ length: cell.futures }, (_, future) => (
          <RoleButton key={future} needs="operator" size="compact-xs" disabled={waiting} aria-label={`Fly future ${future}`} onClick={() => { fly(future); }}>
            {future}
          </RoleButton>
        ))}
      </div>
      <FutureRun run={run} refusal={refusal} />
    </div>
  );
}

interface CellPanelProps {
  readonly atlas: AtlasDetail;
  readonly place: Pick<AtlasCell, "x" | "y"> | null;
  /** Undefined while it has not been flown. */
  readonly cell: AtlasCell | undefined;
}

export function CellPanel({ atlas, place, cell }: CellPanelProps) {
  if (place === null) {
    return (
      <Panel title="Cell">
        <p className={styles.hint}>Press a cell of the map: its two values are staged among the parameters of the mission page, and nothing is applied.</p>
      </Panel>
    );
  }
  return (
    <Panel title="Cell" grow>
      <dl className={styles.facts}>
        <Values atlas={atlas} cell={place} />
        {cell !== undefined && <Outcomes cell={cell} />}
        {cell !== undefined && <Measures atlas={atlas} cell={cell} />}
      </dl>
      {cell === undefined && <p className={styles.hint}>Its futures are still to be flown.</p>}
      {typeof cell?.error === "string" && <p className={styles.hint}>{cell.error}</p>}
      {cell !== undefined && cell.futures > 0 && <Futures key={`${cell.x} ${cell.y}`} atlas={atlas} cell={cell} />}
      <p className={`${styles.hint} ${own.next}`} role="status">
        Both values are staged, not applied: <a href={hashOf({ page: "mission", item: "" })}>rehearse or apply them on the mission page</a>.
      </p>
    </Panel>
  );
}

/** One cell: what it was flown with, what came out, and its run. */
import { Panel } from "../../ui/Panel";
import { Term } from "../glossary/Term";
import { go } from "../../store/route";
import { useAction } from "../../api/use-action";
import { runCell } from "../../api/service";
import type { CommandRequest, StudyDetail, StudyRow } from "../../api/types";
import { RoleButton } from "../access/RoleButton";
import { PrepareButton } from "../commands/PrepareButton";
import { plain, shown } from "../../units/units";
import { nested } from "./definition";
import { classStyle } from "../glossary/class-style";
import { axisName } from "./geometry";
import styles from "./StudiesPage.module.css";

type Flat = Readonly<Record<string, unknown>>;

/** Makes the live mission this cell, bit for bit: its configuration and its seed, at rest; the operator flies it. */
function preparation(study: StudyDetail, row: StudyRow): CommandRequest {
  const definition = study.definition as { configuration?: string; changes?: Flat };
  const varied = Object.fromEntries(study.axes.map((axis) => [axis.path, row[axis.path]]));
  return {
    command: "reset",
    configuration: definition.configuration ?? "published",
    changes: nested({ ...definition.changes, ...varied, "simulation.seed": row["seed"] }),
  };
}

const isDirect = (study: StudyDetail): boolean => (study.definition as { direct?: boolean }).direct === true;

const LABELS: readonly (readonly [string, string])[] = [
  ["outcome", "Outcome, by the study's rule"],
  ["at_first_closure", "Paper's verdict (at first closure)"],
  ["at_locked_arms", "Verdict (at locked arms)"],
  ["caged", "Caged"],
  ["cage_margin", "Cage margin"],
  ["peak_tip_force", "Peak force, to locked arms"],
  ["peak_tip_force_to_closure", "Peak force, to closure"],
  ["closed_at", "Closed at"],
  ["touches", "Touches"],
  ["hardest_touch_arm", "Hardest touch, arm"],
  ["hardest_touch_start", "Hardest touch, at"],
  ["final_target_spin", "Final spin"],
  ["min_manipulability", "Minimum manipulability"],
  ["engine", "Simulated by"],
];

function words(study: StudyDetail, column: string, value: StudyRow[string]): string {
  if (value === null || value === undefined) return "—";
  if (typeof value === "string" || typeof value === "boolean") return classStyle(String(value)).words;
  if (typeof value !== "number") return "";
  const unit = shown(study.columns.find((each) => each.name === column)?.unit ?? "1", "rad").unit;
  return `${plain(Number(value.toPrecision(4)))} ${unit}`;
}

export function CellPanel({ study, row }: { readonly study: StudyDetail; readonly row: StudyRow | undefined }) {
  const { runAction, waiting, refusal } = useAction();
  if (row === undefined) {
    return (
      <Panel title="Cell">
        <p className={styles.hint}>Select a cell of the map for its parameters, its results and its run.</p>
      </Panel>
    );
  }
  const cell = Number(row["cell"]);
  const keep = async () => {
    go("runs", (await runCell(study.id, cell)).id);
  };
  return (
    <Panel title={`Cell ${cell}`} grow>
      <dl className={styles.facts}>
        {study.axes.map((axis) => (
          <div key={axis.path}>
            <dt>{axisName(axis.path)}</dt>
            <dd>{words(study, axis.path, row[axis.path] ?? null)}</dd>
          </div>
        ))}
        {LABELS.map(([column, label]) => (
          <div key={column}>
            <dt>
              <Term term={column}>{label}</Term>
            </dt>
            <dd>{words(study, column, row[column] ?? null)}</dd>
          </div>
        ))}
      </dl>
      {typeof row["error"] === "string" && <p className={styles.hint}>{row["error"]}</p>}
      <div className={styles.actions}>
        <PrepareButton label="Set up as live mission" request={preparation(study, row)} />
        <RoleButton needs="operator" disabled={waiting} onClick={() => void runAction(keep)}>
          Save as a run
        </RoleButton>
      </div>
      <p className={styles.hint}>{`It then waits on the mission page until ${isDirect(study) ? "Direct caging" : "Capture"} is pressed.`}</p>
      {refusal && (
        <p className={styles.trouble} role="alert">
          <strong>{refusal.message}</strong> <span>{refusal.tip}</span>
        </p>
      )}
    </Panel>
  );
}

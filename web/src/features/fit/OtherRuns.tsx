/** Runs of the library that are explained together with this one, or held out: of those only peak forces are foretold. */
import { Checkbox, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { listRuns } from "../../api/service";
import type { RunSummary } from "../../api/types";
import styles from "./Fit.module.css";
import { MOST_RUNS, runWords, withRole, type Role, type Roles } from "./words";

/** So many are listed, the newest first; a search finds the others. */
const LISTED = 12;

const NONE: readonly RunSummary[] = [];

async function found(text: string): Promise<readonly RunSummary[]> {
  const page = await listRuns({ limit: LISTED, ...(text.trim() !== "" && { text: text.trim() }) }, null);
  return page?.body.runs ?? NONE;
}

const isFit = ({ ticks, status }: RunSummary): boolean => ticks > 0 && status !== "queued" && status !== "running";

interface RowProps {
  readonly run: RunSummary;
  readonly roles: Roles;
  readonly choose: (roles: Roles) => void;
}

function Row({ run, roles, choose }: RowProps) {
  const words = runWords(run);
  const box = (role: Role, label: string) => {
    const full = [...roles.values()].filter((each) => each === role).length >= MOST_RUNS[role] && roles.get(run.id) !== role;
    return (
      <td>
        <Checkbox size="xs" aria-label={`${label}: ${words}`} title={full ? `At most ${MOST_RUNS[role]}` : undefined} disabled={full} checked={roles.get(run.id) === role} onChange={(event) => { choose(withRole(roles, run.id, event.currentTarget.checked ? role : null)); }} />
      </td>
    );
  };
  return (
    <tr>
      <th scope="row" title={run.id}>{words}</th>
      {box("fitted", "Fit too")}
      {box("held out", "Hold out")}
    </tr>
  );
}

interface OtherRunsProps {
  /** The run whose page it is. */
  readonly run: string;
  readonly roles: Roles;
  readonly choose: (roles: Roles) => void;
}

export function OtherRuns({ run, roles, choose }: OtherRunsProps) {
  const [opened, setOpened] = useState(false);
  const [text, setText] = useState("");
  const { data } = useQuery({ queryKey: ["runs to fit", text], queryFn: () => found(text), enabled: opened });
  const runs = (data ?? NONE).filter((each) => each.id !== run && isFit(each));
  const count = (role: Role): number => [...roles.values()].filter((each) => each === role).length;
  return (
    <details className={styles.fold} onToggle={(event) => { setOpened(event.currentTarget.open); }}>
      <summary>
        Other runs <span>{`${count("fitted")} fitted too, ${count("held out")} held out`}</span>
      </summary>
      <TextInput aria-label="Find other runs" placeholder="Name, tag or note" size="xs" value={text} onChange={(event) => { setText(event.currentTarget.value); }} />
      {runs.length === 0 ? (
        <p className={styles.none}>{data === undefined ? "The library is read." : "No matching runs"}</p>
      ) : (
        <table className={styles.table}>
          <thead>
            <tr>
              <th scope="col">Run</th>
              <th scope="col" title="Explained together with this one">Fit</th>
              <th scope="col" title="Its peak forces are only foretold">Hold out</th>
            </tr>
          </thead>
          <tbody>
            {runs.map((each) => (
              <Row key={each.id} run={each} roles={roles} choose={choose} />
            ))}
          </tbody>
        </table>
      )}
    </details>
  );
}

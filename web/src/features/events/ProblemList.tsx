/** What is wrong now, and what to do about it; not there when nothing is. */
import { Panel } from "../../app/Panel";
import { useSnapshot } from "../../store/context";
import { Icon, SEVERITY_SIGN } from "../../theme/Icon";
import { clock } from "../../units/units";
import styles from "./ProblemList.module.css";

export function ProblemList() {
  const problems = useSnapshot((snapshot) => snapshot.problems) ?? [];
  if (problems.length === 0) return null;
  return (
    <Panel title={problems.length === 1 ? "1 problem" : `${problems.length} problems`} dated="service">
      <ul className={styles.list} aria-live="polite">
        {problems.map((problem) => (
          <li key={problem.title} className={styles.problem} data-severity={problem.severity}>
            <Icon sign={SEVERITY_SIGN[problem.severity]} size={16} />
            <div>
              <h3>
                {problem.title} <span>since {clock(problem.since, 1)}</span>
              </h3>
              <p>{problem.message}</p>
              {problem.tip !== "" && <p className={styles.tip}>Tip: {problem.tip}</p>}
            </div>
          </li>
        ))}
      </ul>
    </Panel>
  );
}

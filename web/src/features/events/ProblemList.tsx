/** What is wrong now, and what to do about it, in a place of its own that is always there, so that nothing jumps. */
import { Panel } from "../../ui/Panel";
import { hashOf } from "../../store/route";
import { useSnapshot } from "../../store/context";
import { Icon, SEVERITY_ICON } from "../../ui/theme/Icon";
import { clock } from "../../units/units";
import styles from "./ProblemList.module.css";

const RUN = /(\d{8}T\d{9}-[0-9a-f]{6})/;

/** A message whose runs can be opened. */
function Message({ text }: { readonly text: string }) {
  return (
    <p>
      {text.split(RUN).map((part, place) => (RUN.test(part) ? <a key={`${place} ${part}`} href={hashOf({ page: "runs", item: part })}>{part}</a> : part))}
    </p>
  );
}

function titleOf(count: number): string {
  if (count === 0) return "Problems";
  return count === 1 ? "1 problem" : `${count} problems`;
}

export function ProblemList() {
  const problems = useSnapshot((snapshot) => snapshot.problems) ?? [];
  return (
    <Panel title={titleOf(problems.length)} dated="service">
      <ul className={styles.list} aria-live="polite" tabIndex={0} aria-label="Problems">
        {problems.length === 0 && <li className={styles.none}>None.</li>}
        {problems.map((problem) => (
          <li key={problem.title} className={styles.problem} data-severity={problem.severity}>
            <Icon icon={SEVERITY_ICON[problem.severity]} size={16} />
            <div>
              <h3>
                {problem.title} <span>since {clock(problem.since, 1)}</span>
              </h3>
              <Message text={problem.message} />
              {problem.tip !== "" && <p className={styles.tip}>Tip: {problem.tip}</p>}
            </div>
          </li>
        ))}
      </ul>
    </Panel>
  );
}

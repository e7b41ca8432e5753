/** Go or no-go beside the commands: quiet, in a place of its own, so that nothing jumps. */
import type { LookAhead } from "../../api/types";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { lineOf, type LineWords } from "./look-ahead";
import styles from "./LookAheadLine.module.css";

const SIGNS: Readonly<Record<LineWords["verdict"], { readonly icon: IconName; readonly words: string }>> = {
  go: { icon: "check", words: "Go" },
  "no-go": { icon: "warning", words: "No go" },
  unknown: { icon: "bar", words: "" },
};

export function LookAheadLine({ ahead }: { readonly ahead: LookAhead | null }) {
  const { verdict, words } = lineOf(ahead);
  const sign = SIGNS[verdict];
  return (
    <p className={styles.line} data-go={verdict} title={ahead?.reason ?? undefined}>
      <Icon icon={sign.icon} size={12} />
      <span>
        {sign.words !== "" && <strong role="status">{sign.words}</strong>} {words}
      </span>
    </p>
  );
}

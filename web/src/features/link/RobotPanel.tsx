/** What the robot does and for whom, and the taring of its wrists. */
import { Button, Tooltip } from "@mantine/core";
import { useState } from "react";
import { Facts, type Fact } from "../../ui/Facts";
import { Panel } from "../../ui/Panel";
import { useAction } from "../../api/use-action";
import { tareWrists } from "../../api/service";
import type { LinkStatus } from "../../api/types";
import { Icon } from "../../ui/theme/Icon";
import { useReasonAgainstCommanding } from "../control/control";
import styles from "./LinkPage.module.css";
import { age, holderOf, modeOf, sentence } from "./labels";

/** Asks the robot to take what its wrists read now as zero, and shows what became of it. */
function Tare({ tared }: { readonly tared: boolean | null }) {
  const disabledReason = useReasonAgainstCommanding();
  const { runAction, waiting, refusal } = useAction();
  const [answer, setAnswer] = useState("");
  const tare = async () => {
    setAnswer("");
    setAnswer((await tareWrists()).message);
  };
  return (
    <div className={styles.tare}>
      <Tooltip label={disabledReason ?? "Zeroes the force sensors of both wrists. The hands must not touch anything."}>
        <Button
          data-disabled={disabledReason !== null}
          aria-disabled={disabledReason !== null}
          aria-busy={waiting}
          loading={waiting}
          onClick={() => {
            if (disabledReason === null) void runAction(tare);
          }}
        >
          Tare wrists
        </Button>
      </Tooltip>
      <p role="status" aria-live="polite" data-verdict={waiting ? "waiting" : refusal ? "refused" : answer === "" ? undefined : "accepted"}>
        {refusal ? (
          <span className={styles.word} data-tone="error">
            <Icon icon="cross" size={12} /> {sentence(refusal.message)} {sentence(refusal.tip)}
          </span>
        ) : answer !== "" ? (
          <span className={styles.word} data-tone="calm">
            <Icon icon="check" size={12} /> Tared: {answer}.
          </span>
        ) : (
          tared !== null && <span>{tared ? "Tared since the robot was started." : "Not tared since the robot was started."}</span>
        )}
      </p>
    </div>
  );
}

function RobotFacts({ link }: { readonly link: LinkStatus }) {
  const { robot, stop } = link;
  const facts: readonly Fact[] = [
    ["Robot", given(link.robot_identity, "—")],
    ...(link.other_robots.length > 0 ? [["Other robots", link.other_robots.join(", ")] as const] : []),
    ["Held by", holderOf(link)],
    ["Robot's session", given(link.holder, "—")],
    ["This session", given(link.session, "—")],
    ["Commands followed", String(robot?.commands ?? "—")],
    ["Commands refused", String(robot?.refused ?? "—")],
    ["Last refusal", given(robot?.last_refusal, "none")],
    ...link.refused_messages.map((each) => [`Refused: ${each.name}`, `${each.refused}, last ${age(each.refusal_age)} ago: ${each.last_refusal}`] as const),
    ["Last STOP", stop === null ? "none" : stopWords(stop)],
    ["Contract", `robot ${given(robot?.contract, "—")}, console ${link.contract}`],
    ["Endpoints", link.endpoints.join(", ")],
  ];
  return (
    <dl className={styles.facts}>
      <Facts facts={facts} />
    </dl>
  );
}

/** What there is, or a word for that there is nothing. */
const given = (text: string | undefined, otherwise: string): string => (text === undefined || text === "" ? otherwise : text);

const stopWords = (stop: NonNullable<LinkStatus["stop"]>): string =>
  stop.acknowledged_after === null
    ? `sent ${age(stop.age)} ago, not acknowledged`
    : `acknowledged after ${age(stop.acknowledged_after)}`;

export function RobotPanel({ link }: { readonly link: LinkStatus }) {
  const mode = modeOf(link);
  return (
    <Panel title="Robot" dated="service">
      <div className={styles.mode} data-tone={mode.tone} role="status" aria-label={`Robot: ${mode.word}`}>
        <Icon icon={mode.icon} size={26} />
        <strong>{mode.word}</strong>
        <p>{mode.detail}</p>
      </div>
      {link.problem !== null && (
        <p className={styles.problem} role="alert">
          <Icon icon="error" /> The robot cannot be flown: {link.problem}.
        </p>
      )}
      <RobotFacts link={link} />
      <Tare tared={link.robot?.tared ?? null} />
    </Panel>
  );
}

/** Who is in control, at the top of every page, and how that changes. */
import { Button } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { useAction, type RunAction } from "../../api/use-action";
import { changeControl, readControl } from "../../api/service";
import type { Control } from "../../api/types";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { Choice } from "../../ui/Choice";
import { Popup } from "../../ui/Popup";
import { reasonByRole, useAccess } from "../access/session";
import { controlWords, holdOf, useControl, type Hold } from "./control";
import styles from "./ControlState.module.css";

const ICONS: Readonly<Record<Hold, IconName>> = { free: "bar", mine: "check", offered: "follow", others: "lock" };

interface ActionsProps {
  readonly control: Control;
  readonly me: string;
  readonly runAction: RunAction;
}

/** Whom it may be handed over to: asked for when the choice is opened. */
function useOthers(me: string): readonly string[] {
  // Without an answer there is nobody to choose, and the link's own notice says why.
  const { data } = useQuery({ queryKey: ["control"], queryFn: readControl });
  return data?.operators.filter((name) => name !== me) ?? [];
}

function Mine({ control, me, runAction }: ActionsProps) {
  const others = useOthers(me);
  const [chosen, setChosen] = useState<string | null>(null);
  const to = chosen ?? others[0] ?? "";
  return (
    <>
      <p>{control.offered_to === null ? "Everyone else can watch, and can press STOP." : `${control.offered_to} has to accept. Until then you stay in control.`}</p>
      <div className={styles.pair}>
        <Choice within aria-label="Operator to hand over to" disabled={others.length === 0} data={others} value={to === "" ? "no other operator" : to} onChange={setChosen} />
        <Button disabled={to === ""} onClick={() => void runAction(() => changeControl({ action: "hand_over", to }))}>
          Hand over
        </Button>
      </div>
      <Button onClick={() => void runAction(() => changeControl({ action: "release_control" }))}>Release control</Button>
    </>
  );
}

function Actions(props: ActionsProps) {
  const { control, me, runAction } = props;
  const hold = holdOf(control, me);
  if (hold === "mine") return <Mine {...props} />;
  if (hold !== "others") {
    return (
      <>
        <p>{hold === "free" ? "Sending a command takes control, too." : `${control.holder ?? ""} stays in control until you take it.`}</p>
        <Button variant="filled" onClick={() => void runAction(() => changeControl({ action: "take_control" }))}>
          Take control
        </Button>
      </>
    );
  }
  return (
    <>
      <p>{`Ask ${control.holder ?? ""} to hand over. Relieving takes control at once and is logged with your name.`}</p>
      <ConfirmButton label={`Relieve ${control.holder ?? ""}`} question={`Really relieve ${control.holder ?? ""}?`} disabledReason={null} onConfirm={() => void runAction(() => changeControl({ action: "relieve" }))} />
    </>
  );
}

/** Nothing where no tokens are needed: everyone is the same operator there. */
export function ControlState() {
  const { session } = useAccess();
  const control = useControl();
  const { runAction: asked, refusal } = useAction();
  const [opened, setOpened] = useState(false);
  const runAction: RunAction = (work) =>
    asked(async () => {
      await work();
      setOpened(false);
    });
  if (session === null || !session.token_needed || session.name === null || control === null) return null;
  const words = controlWords(control, session.name);
  const hold = holdOf(control, session.name);
  const icon = <Icon icon={ICONS[hold]} size={13} />;
  if (reasonByRole(session, "operator") !== null) {
    return (
      <span className={styles.state} data-hold={hold} role="status">
        {icon} <span className={styles.words} title={words}>{words}</span>
      </span>
    );
  }
  return (
    <Popup
      opened={opened}
      onChange={setOpened}
      target={
        <Button className={styles.state ?? ""} data-hold={hold} leftSection={icon} aria-label={`Control of the mission: ${words}`} onClick={() => { setOpened(!opened); }}>
          <span className={styles.words} title={words}>{words}</span>
        </Button>
      }
    >
      <div className={styles.actions} key={hold}>
        <Actions control={control} me={session.name} runAction={runAction} />
        {refusal !== null && <p role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
      </div>
    </Popup>
  );
}

/** A command as a button that shows waiting, and says why it cannot be pressed. */
import { Button, Tooltip, type ButtonProps } from "@mantine/core";
import { useState, type SyntheticEvent } from "react";
import type { CommandRequest } from "../../api/types";
import { useSnapshot, useView } from "../../store/context";
import type { MissionView } from "../../store/mission";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { useReasonAgainstCommanding } from "../control/control";
import type { CommandWords } from "./catalogue";
import { useDesk, useDeskView } from "./context";
import { isSame, type Caution } from "./desk";
import { ARMED_STYLE, SecondsLeft } from "./SecondsLeft";

/** Why a command may not be given now; null if it may. */
export function reasonAgainst(view: MissionView, command: string): string | null {
  if (view.trust === "preparing") return "The controller is still being compiled.";
  if (view.trust !== "live" || view.snapshot === null) return "The data are stale; commands are disabled until they are fresh.";
  return view.snapshot.commands[command] ?? null;
}

interface CommandButtonProps extends ButtonProps {
  readonly words: CommandWords;
  readonly icon?: IconName;
  /** What goes along with the command. */
  readonly request?: Omit<CommandRequest, "command">;
  /** Why the page itself will not have it now. */
  readonly disabledReason?: string | null;
  /** What is lost if it is given; it then takes a second press. */
  readonly warning?: string | null;
}

/** What the second press will do, for what takes two; null for what takes one. */
export function cautionOf(withRobot: string, byService: boolean, warning: string | null): Caution | null {
  if (!byService && warning === null) return null;
  const sentences = [warning, byService ? withRobot : null, "Press again to confirm."];
  return { words: sentences.filter((each) => each !== null).join(" "), byService };
}

/** Pixels between the panel and a tip. */
const TIP_GAP = 6;
/** The least room beside the panel for a tip. */
const TIP_ROOM = 240;

interface TipPlace {
  readonly position: "right" | "bottom";
  readonly offset: number;
}

/** Beside the panel of commands, or where there is no room below it: a tip never lies over a neighbouring command. */
function tipPlaceOf(button: HTMLElement): TipPlace {
  const panel = (button.closest("section") ?? button).getBoundingClientRect();
  const { right, bottom } = button.getBoundingClientRect();
  if (window.innerWidth - panel.right >= TIP_ROOM) return { position: "right", offset: panel.right - right + TIP_GAP };
  return { position: "bottom", offset: panel.bottom - bottom + TIP_GAP };
}

export function CommandButton({ words, icon, request = {}, disabledReason = null, warning = null, ...button }: CommandButtonProps) {
  const desk = useDesk();
  const byWho = useReasonAgainstCommanding();
  const byMission = useView((view) => reasonAgainst(view, words.command));
  const reason = byWho ?? byMission ?? disabledReason;
  const waiting = useDeskView((view) => view.waiting.has(words.command));
  const byService = useSnapshot((snapshot) => snapshot.arming_needed.includes(words.command)) ?? false;
  const asked: CommandRequest = { command: words.command, ...request };
  const armed = useDeskView((view) => (view.armed !== null && isSame(view.armed.request, asked) ? view.armed : null));
  const [tip, setTip] = useState<TipPlace>({ position: "right", offset: TIP_GAP });
  const placeTip = (event: SyntheticEvent<HTMLElement>): void => {
    setTip(tipPlaceOf(event.currentTarget));
  };
  const press = (): void => {
    if (reason !== null) desk.explain(words.command, reason);
    else void desk.press(asked, cautionOf(words.withRobot ?? "The robot will move.", byService, warning));
  };
  return (
    <Tooltip label={reason ?? words.does} {...tip} w={220} disabled={armed !== null}>
      <Button
        {...button}
        {...(armed && ARMED_STYLE)}
        leftSection={icon && <Icon icon={icon} />}
        // Not `disabled`: it must keep the focus and be able to say why.
        data-disabled={reason !== null}
        aria-disabled={reason !== null}
        aria-busy={waiting}
        aria-label={armed === null ? words.label : `Go: ${words.label}`}
        loading={waiting}
        onClick={press}
        onPointerEnter={placeTip}
        onFocus={placeTip}
        onBlur={() => {
          if (armed) desk.disarm();
        }}
      >
        {armed === null ? words.label : <SecondsLeft until={armed.until} />}
      </Button>
    </Tooltip>
  );
}

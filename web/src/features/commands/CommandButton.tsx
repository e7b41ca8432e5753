/** A command as a button that shows waiting, and says why it cannot be pressed. */
import { Button, Tooltip, type ButtonProps } from "@mantine/core";
import type { CommandRequest } from "../../api/types";
import { useView } from "../../store/context";
import type { MissionView } from "../../store/mission";
import { Icon, type Sign } from "../../theme/Icon";
import { useReasonByRole } from "../access/session";
import type { CommandWords } from "./catalogue";
import { useDesk, useDeskView } from "./context";

/** Why a command may not be given now; null if it may. */
export function reasonAgainst(view: MissionView, command: string): string | null {
  if (view.trust === "preparing") return "The controller is still being compiled.";
  if (view.trust !== "live" || view.snapshot === null) return "The data are old; commands wait for fresh ones.";
  return view.snapshot.commands[command] ?? null;
}

interface CommandButtonProps extends ButtonProps {
  readonly words: CommandWords;
  readonly sign?: Sign;
  /** What goes along with the command. */
  readonly request?: Omit<CommandRequest, "command">;
  /** Why the page itself will not have it now. */
  readonly against?: string | null;
}

export function CommandButton({ words, sign, request = {}, against = null, ...button }: CommandButtonProps) {
  const desk = useDesk();
  const byRole = useReasonByRole("operator");
  const byMission = useView((view) => reasonAgainst(view, words.command));
  const reason = byRole ?? byMission ?? against;
  const waiting = useDeskView((view) => view.waiting.has(words.command));
  const press = (): void => {
    if (reason !== null) desk.explain(words.command, reason);
    else void desk.send({ command: words.command, ...request });
  };
  return (
    <Tooltip label={reason ?? words.does} position="right">
      <Button
        {...button}
        leftSection={sign && <Icon sign={sign} />}
        // Not `disabled`: it must keep the focus and be able to say why.
        data-disabled={reason !== null}
        aria-disabled={reason !== null}
        aria-busy={waiting}
        loading={waiting}
        onClick={press}
      >
        {words.label}
      </Button>
    </Tooltip>
  );
}

/** Flies futures of the mission as it is, and as it would be with the staged changes. */
import { Button, type ButtonProps } from "@mantine/core";
import { useRehearse } from "./use-rehearse";

export function RehearseButton(button: ButtonProps) {
  const { reason, rehearse } = useRehearse();
  return (
    <Button {...button} disabled={reason !== null} title={reason ?? "Flies futures from the present state, as it is and with the staged changes; nothing moves"} onClick={rehearse}>
      Rehearse
    </Button>
  );
}

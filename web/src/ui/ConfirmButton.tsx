/** A button that asks once more before it does what cannot be undone. */
import { Button } from "@mantine/core";
import { useState } from "react";

interface ConfirmButtonProps {
  readonly label: string;
  readonly question: string;
  /** Why it may not be pressed; null if it may. */
  readonly disabledReason: string | null;
  readonly compact?: boolean;
  readonly onConfirm: () => void;
}

export function ConfirmButton({ label, question, disabledReason, compact = false, onConfirm }: ConfirmButtonProps) {
  const [asking, setAsking] = useState(false);
  return (
    <Button
      size={compact ? "compact-xs" : "xs"}
      disabled={disabledReason !== null}
      title={disabledReason ?? undefined}
      onClick={() => {
        if (asking) onConfirm();
        else setAsking(true);
      }}
      onBlur={() => {
        setAsking(false);
      }}
    >
      {asking ? question : label}
    </Button>
  );
}

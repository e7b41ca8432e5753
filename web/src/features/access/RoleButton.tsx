/** A button for what takes a role; without it, it is disabled and says which one is missing. */
import { Button, type ButtonProps } from "@mantine/core";
import type { ReactNode } from "react";
import type { Role } from "../../api/types";
import { useReasonByRole } from "./session";

interface RoleButtonProps extends ButtonProps {
  readonly needs: Role;
  readonly "aria-label"?: string;
  readonly onClick: () => void;
  readonly children: ReactNode;
}

export function RoleButton({ needs, disabled = false, ...button }: RoleButtonProps) {
  const disabledReason = useReasonByRole(needs);
  return <Button {...button} disabled={disabled || disabledReason !== null} title={disabledReason ?? undefined} />;
}

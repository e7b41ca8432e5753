/** A small panel that opens at a button. */
import { Popover } from "@mantine/core";
import type { ReactElement, ReactNode } from "react";
import { EscNote } from "./EscNote";

interface PopupProps {
  /** The button that opens it. */
  readonly target: ReactElement;
  /** Whether it is open, where that is decided outside. */
  readonly opened?: boolean;
  readonly onChange?: (opened: boolean) => void;
  readonly children: ReactNode;
}

export function Popup({ target, children, ...state }: PopupProps) {
  return (
    <Popover position="bottom-end" trapFocus {...state}>
      <Popover.Target>{target}</Popover.Target>
      <Popover.Dropdown>
        {children}
        <EscNote />
      </Popover.Dropdown>
    </Popover>
  );
}

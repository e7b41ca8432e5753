/** Over the page while a person looks for something or reads; STOP stays above it, and Esc closes it and stops. */
import { FocusTrap } from "@mantine/core";
import { useEffect, type ReactNode } from "react";
import { EscNote } from "./EscNote";
import styles from "./ui.module.css";

interface OverlayProps {
  readonly label: string;
  readonly onClose: () => void;
  readonly children: ReactNode;
}

export function Overlay({ label, onClose, children }: OverlayProps) {
  useEffect(() => {
    const close = (event: KeyboardEvent): void => {
      if (event.key === "Escape") onClose();
    };
    window.addEventListener("keydown", close);
    return () => {
      window.removeEventListener("keydown", close);
    };
  }, [onClose]);
  return (
    <div className={styles.over} onPointerDown={(event) => { if (event.target === event.currentTarget) onClose(); }}>
      <FocusTrap>
        <div className={styles.overlay} role="dialog" aria-modal="true" aria-label={label}>
          {children}
          <EscNote />
        </div>
      </FocusTrap>
    </div>
  );
}

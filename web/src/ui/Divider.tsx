/** Between two panels: dragged, or moved by the arrow keys; a double click, or Home, lets it stand where it stood. */
import { useRef, type KeyboardEvent, type PointerEvent } from "react";
import styles from "./ui.module.css";

interface DividerProps {
  readonly label: string;
  /** Of the line itself. */
  readonly orientation: "vertical" | "horizontal";
  readonly value: number;
  readonly bounds: readonly [number, number];
  /** For a press of an arrow. */
  readonly step: number;
  /** The value that a pointer at that place means. */
  readonly valueAt: (x: number, y: number) => number;
  /** Whether an arrow to the right, or down, makes the value larger. */
  readonly grows: boolean;
  /** Null: as it was at first. */
  readonly onChange: (value: number | null) => void;
}

export function Divider({ label, orientation, value, bounds, step, valueAt, grows, onChange }: DividerProps) {
  const dragged = useRef(false);
  const onKeyDown = (event: KeyboardEvent): void => {
    const [less, more] = orientation === "vertical" ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
    if (event.key === "Home") onChange(null);
    else if (event.key === less) onChange(value + (grows ? -step : step));
    else if (event.key === more) onChange(value + (grows ? step : -step));
    else return;
    event.preventDefault();
  };
  const onPointerDown = (event: PointerEvent<HTMLDivElement>): void => {
    dragged.current = true;
    event.currentTarget.setPointerCapture(event.pointerId);
    event.preventDefault();
  };
  return (
    <div
      className={styles.divider}
      role="separator"
      aria-label={label}
      aria-orientation={orientation}
      aria-valuenow={Math.round(value)}
      aria-valuemin={bounds[0]}
      aria-valuemax={bounds[1]}
      title={`${label}: drag, or arrow keys; double click for its usual place`}
      tabIndex={0}
      onKeyDown={onKeyDown}
      onPointerDown={onPointerDown}
      onPointerMove={(event) => { if (dragged.current) onChange(valueAt(event.clientX, event.clientY)); }}
      onPointerUp={() => { dragged.current = false; }}
      onPointerCancel={() => { dragged.current = false; }}
      onDoubleClick={() => { onChange(null); }}
    />
  );
}

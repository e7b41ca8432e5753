/** Moves a panel of the mission page: dragged, or by the arrow keys. */
import { useRef, type KeyboardEvent, type PointerEvent } from "react";
import { COLUMNS, PANEL_LABELS, steppedTo, type Arrangement, type Column, type PanelName, type Place } from "./arrangement";
import styles from "./panels.module.css";

interface MoveHandleProps {
  readonly name: PanelName;
  readonly arrangement: Arrangement;
  readonly onMove: (name: PanelName, place: Place) => void;
}

/** What is marked while a panel is dragged over it. */
const MARK = "data-drop";

const boxOf = (panel: Element): DOMRect => (panel.firstElementChild ?? panel).getBoundingClientRect();

const columnElements = (): HTMLElement[] => [...document.querySelectorAll<HTMLElement>("[data-column]")];

/** The column under the pointer, and between which of its other panels. */
function placeAt(name: PanelName, x: number, y: number): Place | null {
  const element = columnElements().find((each) => {
    const { left, right } = each.getBoundingClientRect();
    return x >= left && x <= right;
  });
  const column: Column | undefined = COLUMNS.find((each) => each === element?.dataset["column"]);
  if (element === undefined || column === undefined) return null;
  const others = [...element.querySelectorAll<HTMLElement>("[data-panel]")].filter(({ dataset }) => dataset["panel"] !== name);
  const at = others.filter((panel) => y > boxOf(panel).top + boxOf(panel).height / 2).length;
  return { column, at };
}

/** Marks where the panel would stand; null takes the mark away. */
function mark(name: PanelName, place: Place | null): void {
  for (const marked of document.querySelectorAll(`[${MARK}]`)) marked.removeAttribute(MARK);
  if (place === null) return;
  const element = columnElements().find(({ dataset }) => dataset["column"] === place.column);
  const others = [...(element?.querySelectorAll<HTMLElement>("[data-panel]") ?? [])].filter(({ dataset }) => dataset["panel"] !== name);
  const [before, after] = [others[place.at], others[place.at - 1]];
  if (before) before.setAttribute(MARK, "before");
  else if (after) after.setAttribute(MARK, "after");
  else element?.setAttribute(MARK, "within");
}

export function MoveHandle({ name, arrangement, onMove }: MoveHandleProps) {
  const dragged = useRef(false);
  const onKeyDown = (event: KeyboardEvent): void => {
    const place = steppedTo(arrangement, name, event.key);
    if (place === null) return;
    event.preventDefault();
    onMove(name, place);
  };
  const end = (event: PointerEvent, kept: boolean): void => {
    if (!dragged.current) return;
    dragged.current = false;
    mark(name, null);
    const place = kept ? placeAt(name, event.clientX, event.clientY) : null;
    if (place !== null) onMove(name, place);
  };
  return (
    <button
      type="button"
      className={styles.handle}
      aria-label={`Move the panel ${PANEL_LABELS[name]}`}
      title="Drag, or move by the arrow keys"
      onKeyDown={onKeyDown}
      onPointerDown={(event) => {
        dragged.current = true;
        event.currentTarget.setPointerCapture(event.pointerId);
      }}
      onPointerMove={(event) => { if (dragged.current) mark(name, placeAt(name, event.clientX, event.clientY)); }}
      onPointerUp={(event) => { end(event, true); }}
      onPointerCancel={(event) => { end(event, false); }}
    >
      <svg width="8" height="12" viewBox="0 0 8 12" aria-hidden="true" fill="currentColor">
        {[2, 6, 10].flatMap((y) => [2, 6].map((x) => <circle key={`${x} ${y}`} cx={x} cy={y} r={1.100} />))}
      </svg>
    </button>
  );
}

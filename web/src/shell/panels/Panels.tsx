/**
 * The smaller panels of the mission page, wherever they stand. Each is drawn into an element of its own that goes from
 * column to column: what was typed into it, unfolded or scrolled to stays.
 */
import { useLayoutEffect, useRef, useState, type ReactNode } from "react";
import { createPortal } from "react-dom";
import { PanelHandleContext } from "../../ui/panel-handle";
import { PANEL_NAMES, type Arrangement, type Column, type PanelName, type Place } from "./arrangement";
import { MoveHandle } from "./MoveHandle";
import styles from "./panels.module.css";

/** The element of each panel. */
export type Hosts = Readonly<Record<PanelName, HTMLElement>>;

function hostOf(name: PanelName): HTMLElement {
  const host = document.createElement("div");
  host.className = styles.host ?? "";
  host.dataset["panel"] = name;
  return host;
}

export function useHosts(): Hosts {
  const [hosts] = useState(() => Object.fromEntries(PANEL_NAMES.map((name) => [name, hostOf(name)])) as Record<PanelName, HTMLElement>);
  return hosts;
}

interface PanelsProps {
  readonly hosts: Hosts;
  readonly panels: Readonly<Record<PanelName, ReactNode>>;
  readonly arrangement: Arrangement;
  readonly onMove: (name: PanelName, place: Place) => void;
}

export function Panels({ hosts, panels, arrangement, onMove }: PanelsProps) {
  return PANEL_NAMES.map((name) =>
    createPortal(<PanelHandleContext value={<MoveHandle name={name} arrangement={arrangement} onMove={onMove} />}>{panels[name]}</PanelHandleContext>, hosts[name], name),
  );
}

/** Where the panels of a column stand. */
export function PanelPlace({ column, hosts, arrangement, className }: { readonly column: Column; readonly hosts: Hosts; readonly arrangement: Arrangement; readonly className: string | undefined }) {
  const place = useRef<HTMLDivElement>(null);
  const names = arrangement[column];
  useLayoutEffect(() => {
    const element = place.current;
    const wanted = names.map((name) => hosts[name]);
    if (element === null || (element.childElementCount === wanted.length && wanted.every((host, at) => element.children[at] === host))) return;
    const focused = document.activeElement;
    element.append(...wanted);
    // What is put elsewhere loses the focus.
    if (focused instanceof HTMLElement && element.contains(focused)) focused.focus();
  }, [names, hosts]);
  return <div ref={place} className={className} />;
}

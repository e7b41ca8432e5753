/** How the mission page is laid out: kept by this browser, and shared as an address: `#/mission?view=plots&left=340&right=320&plots=50&panels=…`. */
import { useEffect } from "react";
import { subscribe } from "../store/route";
import { keepShared, useSharedJson } from "../ui/use-shared";
import { arrangementOf, textOf, USUAL } from "./panels/arrangement";

/** Everything, one panel as large as the page, or big figures for a wall. */
export const VIEWS = ["all", "scene", "plots", "wall"] as const;
export type View = (typeof VIEWS)[number];

export const VIEW_WORDS: Readonly<Record<View, string>> = { all: "Everything", scene: "Scene", plots: "Plots", wall: "Wall" };

/** Widths of the outer columns in pixels, height of the plots in percent of the middle one; null for what fits by itself. */
export interface Layout {
  readonly view: View;
  readonly left: number | null;
  readonly right: number | null;
  readonly plots: number | null;
  /** In which column each panel stands: the text of an arrangement. */
  readonly panels: string;
}

const USUAL_PANELS = textOf(USUAL);

export const DEFAULT_LAYOUT: Layout = { view: "all", left: null, right: null, plots: null, panels: USUAL_PANELS };

/** Beyond these a panel is of no use. */
export const BOUNDS = { left: [240, 640], right: [240, 720], plots: [20, 85] } as const;

export type Size = keyof typeof BOUNDS;
const SIZES = Object.keys(BOUNDS) as readonly Size[];

/** Within its bounds; null of what is no number. */
function sizeOf(size: Size, value: unknown): number | null {
  if (typeof value !== "number" || !Number.isFinite(value)) return null;
  const [least, most] = BOUNDS[size];
  return Math.round(Math.min(most, Math.max(least, value)));
}

const panelsOf = (value: unknown): string => (typeof value === "string" ? textOf(arrangementOf(value)) : USUAL_PANELS);

const viewOf = (value: unknown): View => VIEWS.find((known) => known === value) ?? "all";

/** What was kept; what cannot be is left out. */
export function readLayout(kept: unknown): Layout {
  if (typeof kept !== "object" || kept === null) return DEFAULT_LAYOUT;
  const { view, left, right, plots, panels } = kept as Record<string, unknown>;
  return { view: viewOf(view), left: sizeOf("left", left), right: sizeOf("right", right), plots: sizeOf("plots", plots), panels: panelsOf(panels) };
}

/** What an address asks for; null if it says nothing of it. */
export function layoutOf(hash: string): Layout | null {
  const [path = "", query = ""] = hash.split("?");
  if (query === "" || (path.replace(/^#\/?/, "") || "mission") !== "mission") return null;
  const asked = new URLSearchParams(query);
  const number = (name: string): number | null => (asked.get(name) === null ? null : Number(asked.get(name)));
  return readLayout({ view: asked.get("view"), left: number("left"), right: number("right"), plots: number("plots"), panels: asked.get("panels") });
}

export function addressOf(layout: Layout): string {
  const parts = new URLSearchParams({ view: layout.view });
  for (const size of SIZES) if (layout[size] !== null) parts.set(size, String(layout[size]));
  if (layout.panels !== USUAL_PANELS) parts.set("panels", layout.panels);
  return `#/mission?${parts.toString()}`;
}

export const withSize = (layout: Layout, size: Size, value: number | null): Layout => ({ ...layout, [size]: sizeOf(size, value) });

const KEY = "becalm-layout";

/** The layout of this browser; an address that names one is taken over. */
export function useLayout(): [Layout, (layout: Layout) => void] {
  return useSharedJson(KEY, readLayout);
}

/** Takes over what an address asks for; once for the whole page. */
export function useLayoutAddress(): void {
  useEffect(() => {
    const take = (): void => {
      const asked = layoutOf(location.hash);
      if (asked === null) return;
      keepShared(KEY, JSON.stringify(asked));
    };
    take();
    return subscribe(take);
  }, []);
}

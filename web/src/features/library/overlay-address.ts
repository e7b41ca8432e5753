/** Several runs in one plot, as the address keeps them: `#/runs/overlay?runs=A,B&y=left.hand_force&x=mission.time&align=touch`. */

/** More cannot be told apart by colour. */
export const MOST_OVERLAID = 12;

/** Stands in the address where a run's identifier would. */
export const OVERLAY = "overlay";

/** What of each run lies at the same place of the axis. */
export const ALIGNMENTS = ["motion", "touch", "closure", "clock"] as const;
export type OverlayAlignment = (typeof ALIGNMENTS)[number];

export const TIME = "mission.time";

export interface Overlay {
  readonly runs: readonly string[];
  /** Expressions over columns of the log. */
  readonly x: string;
  readonly y: string;
  readonly align: OverlayAlignment;
}

export const DEFAULT_OVERLAY: Omit<Overlay, "runs"> = { x: TIME, y: "max(left.hand_force, right.hand_force)", align: "touch" };

export function overlayHash(asked: Partial<Overlay>): string {
  const { runs = [], x, y, align } = { ...DEFAULT_OVERLAY, ...asked };
  const parts = new URLSearchParams();
  if (y !== DEFAULT_OVERLAY.y) parts.set("y", y);
  if (x !== DEFAULT_OVERLAY.x) parts.set("x", x);
  if (align !== DEFAULT_OVERLAY.align) parts.set("align", align);
  // Commas stay as they are: an address that is read by people.
  const rest = parts.toString();
  return `#/runs/${OVERLAY}?runs=${runs.map(encodeURIComponent).join(",")}${rest === "" ? "" : `&${rest}`}`;
}

/** What an address asks for; what cannot be is left out. */
export function overlayOf(hash: string): Overlay {
  const asked = new URLSearchParams(hash.split("?")[1] ?? "");
  const runs = (asked.get("runs") ?? "").split(",").filter((id) => id !== "");
  return {
    runs: [...new Set(runs)].slice(0, MOST_OVERLAID),
    x: asked.get("x") ?? DEFAULT_OVERLAY.x,
    y: asked.get("y") ?? DEFAULT_OVERLAY.y,
    align: ALIGNMENTS.find((known) => known === asked.get("align")) ?? DEFAULT_OVERLAY.align,
  };
}

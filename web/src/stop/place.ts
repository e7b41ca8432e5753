/** Keeps STOP in view while fingers zoom: `position: fixed` keeps it at the corner of the page's layout only. */

export interface Viewport {
  readonly offsetLeft: number;
  readonly offsetTop: number;
  readonly width: number;
  readonly scale: number;
}

/** The transform, about the top right corner, of what stands there in a layout so wide; empty if nothing is zoomed. */
export function transformIn({ offsetLeft, offsetTop, width, scale }: Viewport, layoutWidth: number): string {
  if (scale <= 1) return "";
  const left = offsetLeft + width - layoutWidth;
  return `translate(${left.toFixed(2)}px, ${offsetTop.toFixed(2)}px) scale(${(1 / scale).toFixed(4)})`;
}

export function keepInView(element: () => HTMLElement | null): void {
  const viewport = window.visualViewport;
  if (viewport === null) return;
  const follow = (): void => {
    const stop = element();
    if (stop !== null) stop.style.transform = transformIn(viewport, document.documentElement.clientWidth);
  };
  viewport.addEventListener("resize", follow);
  viewport.addEventListener("scroll", follow);
}

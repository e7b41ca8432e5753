/** The tokens as a canvas needs them: resolved for the theme that is shown now. */
export interface CanvasColours {
  readonly text: string;
  readonly faint: string;
  readonly grid: string;
  readonly line: string;
  readonly panel: string;
  readonly of: (token: string) => string;
}

export function canvasColours(): CanvasColours {
  const style = getComputedStyle(document.documentElement);
  const of = (token: string): string => style.getPropertyValue(`--${token}`).trim();
  return { text: of("dim"), faint: of("faint"), grid: of("grid"), line: of("line-strong"), panel: of("panel"), of };
}

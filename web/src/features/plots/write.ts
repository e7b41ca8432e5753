/** A text that is there already is not written again: the browser would lay out the page for it. */
export function write(element: HTMLElement | null | undefined, text: string): void {
  if (element && element.textContent !== text) element.textContent = text;
}

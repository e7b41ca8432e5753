/** Begins the tour, from anywhere on the page. */
const OPENED = "becalm:tour";

export function openTour(): void {
  window.dispatchEvent(new Event(OPENED));
}

export function onTour(listener: () => void): () => void {
  window.addEventListener(OPENED, listener);
  return () => {
    window.removeEventListener(OPENED, listener);
  };
}

/** Says so when the console could not be loaded; what it leaves in `#root` is replaced by the console itself. */
const FAILED = "The console could not be loaded. STOP works all the same. Load the page again; if it stays so, the service's own log says more.";

export function watchLoading(): void {
  const tell = (): void => {
    const waiting = document.getElementById("loading");
    if (waiting !== null) waiting.textContent = FAILED;
  };
  // Errors of loading do not bubble; those of the console's first script come as errors of the window.
  window.addEventListener("error", tell, { capture: true });
  window.addEventListener("unhandledrejection", tell);
}

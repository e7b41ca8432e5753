/** Says so when the console could not be loaded; what it leaves in `#root` is replaced by the console itself. */
const FAILED = "The console could not be loaded. STOP still works. Reload the page; if it keeps failing, check the log of the service.";

export function watchLoading(): void {
  const tell = (): void => {
    const waiting = document.getElementById("loading");
    if (waiting !== null) waiting.textContent = FAILED;
  };
  // Errors of loading do not bubble; those of the console's first script come as errors of the window.
  window.addEventListener("error", tell, { capture: true });
  window.addEventListener("unhandledrejection", tell);
}

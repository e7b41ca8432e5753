/** Leads a person to a parameter of the form, from anywhere on the page. */
const WANTED = "becalm:find-parameter";

export function findParameter(path: string): void {
  window.dispatchEvent(new CustomEvent(WANTED, { detail: path }));
}

/** Calls with the path of the parameter that somebody looks for; the returned function ends it. */
export function onFindParameter(listener: (path: string) => void): () => void {
  const heard = (event: Event): void => {
    if (event instanceof CustomEvent && typeof event.detail === "string") listener(event.detail);
  };
  window.addEventListener(WANTED, heard);
  return () => {
    window.removeEventListener(WANTED, heard);
  };
}

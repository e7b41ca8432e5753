/** What STOP says under its button. */
import type { Verdict } from "./send";

/** Milliseconds for which a good answer stays. */
const SHOWN_TIME = 8000;

/** Phases in which nothing is left to be stopped. */
const AT_REST = ["stopped", "idle"];

export class StopNote {
  private verdict: Verdict["kind"] | null = null;
  private phase: string | null = null;
  private hiding: ReturnType<typeof setTimeout> | undefined;

  /** `place`: the element of the note, which may come later than this. */
  constructor(private readonly place: () => HTMLElement | null) {}

  stopping(): void {
    this.verdict = null;
    this.show("waiting", "Stopping …", "");
  }

  answered({ kind, title, advice }: Verdict): void {
    this.verdict = kind;
    this.show(kind, title, advice);
    if (kind === "stopped") this.hiding = setTimeout(this.hide, SHOWN_TIME);
    else this.known(this.phase);
  }

  /** What fresh data say of the mission: one at rest needs no "not confirmed". */
  readonly known = (phase: string | null): void => {
    this.phase = phase;
    if (this.verdict === "unconfirmed" && phase !== null && AT_REST.includes(phase)) this.hide();
  };

  readonly hide = (): void => {
    clearTimeout(this.hiding);
    this.verdict = null;
    const place = this.place();
    place?.removeAttribute("data-answer");
    place?.replaceChildren();
  };

  private show(verdict: string, title: string, advice: string): void {
    clearTimeout(this.hiding);
    const place = this.place();
    if (place === null) return;
    place.dataset["answer"] = verdict;
    const strong = document.createElement("strong");
    strong.textContent = title;
    place.replaceChildren(strong, ...(advice === "" ? [] : [` ${advice} `, this.dismissal()]));
  }

  private dismissal(): HTMLButtonElement {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "Dismiss";
    button.addEventListener("click", this.hide);
    return button;
  }
}

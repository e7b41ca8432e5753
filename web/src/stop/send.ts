/** How STOP is sent, and what its answer comes to: the only place of the console that knows. */
import { patience } from "./patience";

export interface Verdict {
  /** `unconfirmed`: nobody knows whether the mission stopped. */
  readonly kind: "stopped" | "refused" | "unconfirmed";
  readonly title: string;
  readonly advice: string;
}

/** The path that the form of STOP in `index.html` posts to as well; relative, as the console may lie under a path of another site. */
const ADDRESS = "./api/v1/mission/stop";

/** Milliseconds that one try waits for its answer. */
const ANSWER_TIME = 1500;

/** STOP may be sent again without harm. */
const TRIES = 3;

/** `keepalive`: it is still sent when the page is left right after. */
const post = (): Promise<Response> =>
  fetch(ADDRESS, {
    method: "POST",
    credentials: "same-origin",
    cache: "no-store",
    keepalive: true,
    priority: "high",
    signal: patience(ANSWER_TIME),
  });

const STOPPED: Verdict = { kind: "stopped", title: "Stopped", advice: "" };

const unconfirmed = (why: string): Verdict => ({
  kind: "unconfirmed",
  title: "Not confirmed",
  advice: `${why} Press again, or stop the robot itself.`,
});

function refused(status: number, detail: string): Verdict {
  if (status === 401) return { kind: "refused", title: "Not signed in: STOP was refused", advice: "Sign in, or stop the robot itself." };
  const why = detail === "" ? `The service answered ${status}.` : `${detail}.`;
  return { kind: "refused", title: "STOP was refused", advice: `${why} Stop the robot itself.` };
}

const textOf = (body: unknown, field: string): string => {
  const value: unknown = typeof body === "object" && body !== null ? Reflect.get(body, field) : undefined;
  return typeof value === "string" ? value : "";
};

/** The mission stopped only if the service itself says so: a proxy's sign-in page also comes with status 200. */
async function verdictOf(response: Response): Promise<Verdict> {
  const body: unknown = await response.json().catch(() => null);
  if (response.ok) {
    const accepted = typeof body === "object" && body !== null && Reflect.get(body, "accepted") === true;
    return accepted ? STOPPED : unconfirmed("The answer did not come from the service.");
  }
  if (response.status >= 400 && response.status < 500) return refused(response.status, textOf(body, "detail"));
  return unconfirmed(`The service answered ${response.status}.`);
}

async function attempt(send: () => Promise<Response>): Promise<Verdict> {
  try {
    return await verdictOf(await send());
  } catch (cause) {
    const late = cause instanceof DOMException && cause.name === "TimeoutError";
    return unconfirmed(late ? "The service did not answer in time." : "The service cannot be reached.");
  }
}

/** Sends STOP until it is confirmed or refused, but not for ever: what is sent much later might stop another mission. */
export async function sendStop(send: () => Promise<Response> = post): Promise<Verdict> {
  let verdict = await attempt(send);
  for (let tries = 1; tries < TRIES && verdict.kind === "unconfirmed"; tries += 1) verdict = await attempt(send);
  return verdict;
}

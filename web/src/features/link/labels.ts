/** What the figures of the link mean, in words and signs: no colour stands alone. */
import type { LinkStatus, StreamStatus } from "../../api/types";
import type { IconName } from "../../ui/theme/Icon";
import { duration, fixed } from "../../units/units";

export type Tone = "calm" | "warning" | "error" | "plain";

export interface Word {
  readonly word: string;
  readonly icon: IconName;
  readonly tone: Tone;
  /** One sentence more. */
  readonly detail: string;
}

/** Seconds of silence after which the last report is no longer the robot's present. */
const SILENCE = 0.5;
/** Seconds for which a stream that is late counts as refused. */
const RECENT = 1;

const word = (word: string, icon: IconName, tone: Tone, detail: string): Word => ({ word, icon, tone, detail });

/** What the robot does, as far as this console can know. */
export function modeOf(link: LinkStatus): Word {
  const { robot } = link;
  if (robot === null) return word("No robot", "link", "error", "Nothing has been received from a robot yet.");
  if (robot.age > Math.max(SILENCE, link.deadline ?? 0)) {
    return word("Silent", "link", "error", `Last reported mode, ${duration(robot.age)} ago: ${robot.mode ?? "unknown"}.`);
  }
  switch (robot.mode) {
    case "following":
      return link.held
        ? word("Following", "check", "calm", "It follows the commands of this console.")
        : word("Following another", "lock", "warning", "It follows the commands of another console.");
    case "waiting":
      return word("Waiting", "wait", "plain", sentence(robot.why) || "Nobody holds it.");
    case "holding":
      return word("Holding", "pause", "warning", `${sentence(robot.why)} Reset to take it over again.`);
    case "stopped":
      return word("Stopped", "stop", "error", `${sentence(robot.why)} Reset to take it over again.`);
    case null:
      return word("Unknown mode", "error", "error", "The robot reports a mode that this console does not know.");
  }
}

/** Of what the service tells as the end of a sentence. */
export const sentence = (text: string): string => (text === "" ? "" : `${text.charAt(0).toUpperCase()}${text.slice(1)}.`);

/** Who holds the robot, seen from here. */
export function holderOf({ holder, session, held }: LinkStatus): string {
  if (holder === "") return "nobody";
  if (held) return "this console";
  return holder === session ? "nobody; last this console" : "another console";
}

/** How a stream comes. */
export function streamWord(stream: StreamStatus): Word {
  const refused = stream.late && stream.refusal_age !== null && stream.refusal_age < RECENT;
  if (refused) return word("refused", "cross", stream.needed ? "error" : "warning", sentence(stream.last_refusal));
  if (stream.age === null) return word("none yet", "bar", stream.needed ? "error" : "plain", "Nothing received yet.");
  if (stream.late) return word("late", "error", stream.needed ? "error" : "warning", "Older than the deadline.");
  if (stream.rate < 0.9 * stream.nominal_rate) return word("slow", "warning", "warning", "Slower than the contract's rate.");
  return word("good", "check", "calm", "As specified by the contract.");
}

/** Milliseconds of a time in seconds. */
export const milliseconds = (seconds: number | null, decimals = 1): string => (seconds === null ? "—" : fixed(1000 * seconds, decimals));

/** An age is read in milliseconds as long as that is short. */
export const age = (seconds: number | null): string => {
  if (seconds === null) return "—";
  return seconds < 10 ? `${fixed(1000 * seconds, 0)} ms` : duration(seconds, 0);
};

/** The offset of clocks with its sense, in a unit that fits. */
export function offsetWords(offset: number | null): { readonly value: string; readonly sense: string } {
  if (offset === null) return { value: "—", sense: "unknown until a heartbeat returns" };
  const size = Math.abs(offset);
  const value = size < 1 ? `${fixed(1000 * size, 2)} ms` : `${fixed(size, 4)} s`;
  return { value, sense: offset < 0 ? "the robot's clock is behind" : "the robot's clock is ahead" };
}

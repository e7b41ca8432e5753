/** Where a mission is read from: live telemetry, or a stored run. Panels never know which. */
import type { MissionEvent, MissionSnapshot } from "../api/types";
import type { Sample } from "./quantities";

/** How the way to the data is. */
export type Link =
  | { readonly state: "connecting" }
  | { readonly state: "open" }
  | { readonly state: "lost"; readonly attempt: number; readonly retryAt: number };

/** Takes what a source tells, in the order in which it happened. */
export interface Sink {
  link(link: Link): void;
  /** A whole history: what is known of the mission up to now. */
  history(samples: readonly Sample[]): void;
  snapshot(snapshot: MissionSnapshot): void;
  /** A service, which a restart gives another name, has told the time by its own clock, in seconds, just now. */
  heard(service: string, serviceTime: number): void;
  event(event: MissionEvent): void;
  /** Events were not sent, for this page was too slow; the library has them. */
  missed(): void;
  /** Another mission began; nothing known so far belongs to it. */
  reset(): void;
}

export interface Source {
  /** Begins to tell the sink; the returned function ends it. */
  open(sink: Sink): () => void;
}

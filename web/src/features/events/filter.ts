/** Which events of a mission are shown, and how they leave as a table. */
import type { MissionEvent } from "../../api/types";
import { csvCell } from "../../ui/export/csv";

export const CHOICES = ["all", "severe", "commands", "phases"] as const;
export type EventChoice = (typeof CHOICES)[number];

export const CHOICE_WORDS: Readonly<Record<EventChoice, string>> = { all: "All events", severe: "Warnings, errors", commands: "Commands, changes", phases: "Phases, verdicts" };

const FITS: Readonly<Record<EventChoice, (event: MissionEvent) => boolean>> = {
  all: () => true,
  severe: ({ severity }) => severity !== "info",
  commands: ({ kind }) => kind === "command" || kind === "config",
  phases: ({ kind }) => kind === "phase" || kind === "verdict",
};

/** Of that choice, and with every word that is looked for: in the message, the kind, or the name of who did it. */
export function eventsThatFit(events: readonly MissionEvent[], choice: EventChoice, sought: string): readonly MissionEvent[] {
  const words = sought.toLowerCase().split(/\s+/).filter(Boolean);
  if (choice === "all" && words.length === 0) return events;
  return events.filter((event) => {
    const text = `${event.message} ${event.kind} ${event.who ?? ""}`.toLowerCase();
    return FITS[choice](event) && words.every((word) => text.includes(word));
  });
}

export function eventsAsCsv(events: readonly MissionEvent[]): string {
  const rows = events.map(({ tick, time, at, severity, kind, who, message }) => [tick, time, at, severity, kind, who ?? "", message]);
  return [["tick", "time", "at", "severity", "kind", "who", "message"], ...rows].map((row) => row.map(csvCell).join(",")).join("\r\n") + "\r\n";
}

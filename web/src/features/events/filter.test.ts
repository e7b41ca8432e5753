import { describe, expect, it } from "vitest";
import type { MissionEvent } from "../../api/types";
import { eventsAsCsv, eventsThatFit } from "./filter";

const event = (change: Partial<MissionEvent>): MissionEvent => ({ tick: 1, time: 0.001, at: "2026-11-30T10:00:00.000+00:00", kind: "plan", severity: "info", message: "A touch is planned", who: null, ...change });

const EVENTS = [event({}), event({ kind: "phase", message: "Detumbling begins" }), event({ kind: "command", who: "ana", message: 'capture granted, "go"' }), event({ severity: "warning", kind: "manipulability", message: "left arm near a singularity" })];

describe("the events that are shown", () => {
  it("are those of a choice", () => {
    expect(eventsThatFit(EVENTS, "all", " ")).toBe(EVENTS);
    expect(eventsThatFit(EVENTS, "severe", "")).toEqual([EVENTS[3]]);
    expect(eventsThatFit(EVENTS, "commands", "")).toEqual([EVENTS[2]]);
    expect(eventsThatFit(EVENTS, "phases", "")).toEqual([EVENTS[1]]);
  });

  it("hold every word that is looked for, also of who did it", () => {
    expect(eventsThatFit(EVENTS, "all", "ANA capture")).toEqual([EVENTS[2]]);
    expect(eventsThatFit(EVENTS, "severe", "capture")).toEqual([]);
  });

  it("leave as a table", () => {
    const [head, , , command] = eventsAsCsv(EVENTS).split("\r\n");
    expect(head).toBe("tick,time,at,severity,kind,who,message");
    expect(command).toBe('1,0.001,2026-11-30T10:00:00.000+00:00,info,command,ana,"capture granted, ""go"""');
  });
});

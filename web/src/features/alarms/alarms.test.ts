import { describe, expect, it } from "vitest";
import type { Alarm } from "../../api/types";
import { beyondWords, highest, inOrder, newlySpeaking, noticeWords, speaks, titleOf } from "./alarms";

const alarm = (change: Partial<Alarm>): Alarm => ({
  key: "limit:tip_force",
  signal: "tip_force",
  title: "Tip force",
  message: "",
  tip: "",
  level: "warning",
  active: true,
  value: 2.61234,
  worst: 3,
  bound: 2.5,
  unit: "N",
  side: "above",
  run_id: "A",
  since: 1,
  raised_at: "2026-11-30T10:00:00.000+00:00",
  acknowledged_by: null,
  acknowledged_at: null,
  shelved_by: null,
  shelved_until: null,
  ...change,
});

const SEEN = alarm({ acknowledged_by: "ana", acknowledged_at: "2026-11-30T10:00:01.000+00:00" });
const SHELVED = alarm({ shelved_until: "2026-11-30T11:00:00.000+00:00", level: "critical" });
const WATCH = alarm({ key: "limit:base_rate", level: "watch" });
const CRITICAL = alarm({ key: "problem:Link lost", signal: null, title: "Link lost", message: "silent for 2 s", level: "critical", raised_at: "2026-11-30T09:00:00.000+00:00" });

describe("an alarm", () => {
  it("speaks until somebody has seen or shelved it, but for what is only worth a look", () => {
    expect([alarm({}), CRITICAL, SEEN, SHELVED, WATCH].map(speaks)).toEqual([true, true, false, false, false]);
  });

  it("stands in the order of its urgency", () => {
    expect(inOrder([SHELVED, WATCH, SEEN, alarm({}), CRITICAL])).toEqual([CRITICAL, alarm({}), SEEN, WATCH, SHELVED]);
    expect(highest([WATCH, SEEN])).toBe("warning");
    expect(highest([])).toBeNull();
  });

  it("says how far beyond which limit, in the unit that a person prefers", () => {
    expect(beyondWords(alarm({}), "rad")).toBe("2.612 N, above 2.5 N; worst 3 N");
    expect(beyondWords(alarm({ active: false }), "rad")).toBe("was 3 N, above 2.5 N; over");
    expect(beyondWords(alarm({ unit: "rad", value: Math.PI, worst: Math.PI, bound: 1 }), "deg")).toBe("180 °, above 57.3 °; worst 180 °");
    expect(beyondWords(CRITICAL, "rad")).toBe("silent for 2 s");
    expect(noticeWords(alarm({}), "rad")).toBe("Warning: Tip force, 3 N");
  });

  it("is in the title of the page while it speaks", () => {
    expect(titleOf([], "Caging")).toBe("Caging · Becalm");
    expect(titleOf([alarm({}), SEEN], null)).toBe("(1 !) Becalm");
    expect(titleOf([alarm({}), CRITICAL], "Caging")).toBe("(2 ‼) Caging · Becalm");
  });

  it("is announced once: when it is raised, and when it gets worse", () => {
    expect(newlySpeaking([], [alarm({}), WATCH])).toEqual([alarm({})]);
    expect(newlySpeaking([alarm({})], [alarm({ value: 2.7 })])).toEqual([]);
    const worse = alarm({ level: "critical" });
    expect(newlySpeaking([alarm({})], [worse])).toEqual([worse]);
    expect(newlySpeaking([SEEN], [alarm({ raised_at: "2026-11-30T10:05:00.000+00:00" })])).toHaveLength(1);
  });
});

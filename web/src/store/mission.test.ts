import { describe, expect, it } from "vitest";
import type { MissionEvent, MissionSnapshot } from "../api/types";
import type { Source } from "../source/source";
import { MissionStore } from "./mission";

const still = [0, 0, 0];
const hand = { hand_wrench: still, hand_pose: still, desired_hand_pose: still };
const arm = { ...hand, joint_rate: still, commanded_joint_rate: still, manipulability: 0.02 };
const body = { pose: [0, 0, 0], twist: [0, 0, 0] };

function snapshot(tick: number, phase = "idle"): MissionSnapshot {
  const mission = { tick, time: tick / 1000, service_time: tick / 1000, robot: null, phase, activity: "none", spin: 1, outcome: null };
  return { ...mission, left: arm, right: arm, base: body, target: body } as unknown as MissionSnapshot;
}

const event = (tick: number, message: string): MissionEvent => ({
  tick,
  time: tick / 1000,
  at: "2026-11-22T11:30:00Z",
  kind: "touch",
  severity: "info",
  message,
});

const SOURCE: Source = {
  open: () => () => undefined,
  refreshPeriod: null,
  refresh: () => Promise.resolve(),
  readRange: () => Promise.resolve(null),
  playback: null,
  takePicture: null,
  scene: { changeNeeds: null, read: () => Promise.reject(new Error("none")), change: () => Promise.resolve() },
};

function storeAt(clock: { now: number }): MissionStore {
  const store = new MissionStore(SOURCE, () => clock.now);
  store.link({ state: "open" });
  return store;
}

const health = (status: "ok" | "preparing") => ({
  service_time: 0.005,
  status,
  prepared: status === "ok" ? 1 : 0.4,
  version: "0",
  plant: "simulation" as const,
  tick_age: null,
  link_age: null,
  phase: "idle",
  recorder_lag: 0,
  recorder_failure: null,
  access_failure: null,
});

it("tells panels what goes by ten times a second, however often somebody looks at the clock", () => {
  const clock = { now: 0 };
  const store = storeAt(clock);
  store.snapshot(snapshot(0));
  let told = 0;
  store.subscribe(() => { told += 1; });
  for (clock.now = 1; clock.now <= 2000; clock.now += 1) {
    if (clock.now % 17 === 0) store.snapshot(snapshot(clock.now));
    if (clock.now % 100 === 60) store.checkAge();
  }
  expect(told).toBeGreaterThanOrEqual(15);
  expect(told).toBeLessThanOrEqual(21);
});

describe("trust in what is shown", () => {
  it("goes stale half a second after the last snapshot, and tells the age", () => {
    const clock = { now: 0 };
    const store = storeAt(clock);
    expect(store.read().trust).toBe("connecting");
    store.snapshot(snapshot(0));
    expect(store.read().trust).toBe("live");
    for (clock.now = 100; clock.now <= 500; clock.now += 100) store.checkAge();
    expect(store.read().trust).toBe("live");
    clock.now = 760;
    store.checkAge();
    expect(store.read()).toMatchObject({ trust: "stale", age: 700 });
    store.snapshot(snapshot(700));
    expect(store.read()).toMatchObject({ trust: "live", age: 0 });
  });

  it("lets waiting frames speak first when the browser itself was held up", () => {
    const clock = { now: 0 };
    const store = storeAt(clock);
    store.snapshot(snapshot(0));
    clock.now = 2000;
    store.checkAge();
    expect(store.read().trust).toBe("live");
    store.checkAge();
    store.checkAge();
    expect(store.read().trust).toBe("stale");
  });

  it("goes by when the service made what is shown, not by when it came", () => {
    const clock = { now: 10 };
    const store = storeAt(clock);
    store.health(health("ok"), 0);
    for (clock.now = 3000; clock.now <= 3400; clock.now += 100) {
      store.snapshot(snapshot(clock.now - 2600)); // each is taken at once, and has been on its way for 2.6 s
      store.checkAge();
    }
    expect(store.read().trust).toBe("stale");
    expect(store.read().age).toBeGreaterThanOrEqual(2500);
  });

  it("dates what comes from the robot by the robot", () => {
    const clock = { now: 0 };
    const store = storeAt(clock);
    store.snapshot({ ...snapshot(0), robot: { silent_for: 0.01, oldest: 0.02, stream: "target pose" } });
    expect(store.read().robotAge).toBe(0);
    clock.now = 100;
    store.snapshot({ ...snapshot(100), robot: { silent_for: 3.2, oldest: 3.25, stream: "target pose" } });
    expect(store.read()).toMatchObject({ trust: "live", robotAge: 3200 });
  });

  it("trusts a stored run however old it is, and shows each moment of it at once", () => {
    const clock = { now: 0 };
    const store = new MissionStore(SOURCE, () => clock.now);
    store.link({ state: "stored" });
    store.snapshot(snapshot(0));
    clock.now = 3_600_000;
    store.checkAge();
    expect(store.read()).toMatchObject({ trust: "live", age: 0, robotAge: 0 });
    store.snapshot(snapshot(900));
    clock.now += 1;
    store.snapshot(snapshot(300)); // dragged back
    expect(store.read().snapshot?.tick).toBe(300);
  });

  it("does not trust a lost connection, however fresh its last word", () => {
    const clock = { now: 0 };
    const store = storeAt(clock);
    store.snapshot(snapshot(0));
    store.link({ state: "lost", attempt: 1, retryAt: 1200 });
    expect(store.read()).toMatchObject({ trust: "stale", retryIn: 2000 });
  });

  it("tells preparing from silence", () => {
    const store = storeAt({ now: 0 });
    store.health(health("preparing"), 0);
    expect(store.read().trust).toBe("preparing");
    store.snapshot(snapshot(0));
    expect(store.read().trust).toBe("live");
  });
});

describe("what the panels get", () => {
  it("keeps their pace, but tells a change of phase at once; the series has everything", () => {
    const clock = { now: 0 };
    const store = storeAt(clock);
    store.snapshot(snapshot(0));
    clock.now = 10;
    store.snapshot(snapshot(10));
    expect(store.read().snapshot?.tick).toBe(0);
    clock.now = 20;
    store.snapshot(snapshot(20, "detumbling"));
    expect(store.read().snapshot?.tick).toBe(20);
    expect(store.series.length).toBe(3);
  });

  it("orders events and does not repeat them", () => {
    const store = storeAt({ now: 0 });
    store.events([event(30, "later")]);
    store.events([event(10, "earlier"), event(30, "later")]);
    expect(store.read().events.map((known) => known.message)).toEqual(["earlier", "later"]);
  });

  it("tells whoever comes which run a restart of the service cut off, until it has been read", () => {
    const store = storeAt({ now: 0 });
    const cutOff = { run_id: "old", phase: "detumbling", time: 1.2 };
    store.hello("one", 0, null);
    expect(store.read().cutOff).toBeNull();
    store.hello("two", 1, cutOff);
    store.snapshot({ ...snapshot(1), run_id: "new" });
    expect(store.read().cutOff).toEqual(cutOff);
    store.dismissCutOff();
    store.hello("two", 2, cutOff); // connected again to the same service
    expect(store.read().cutOff).toBeNull();
  });

  it("forgets all of a mission that was reset", () => {
    const store = storeAt({ now: 0 });
    store.snapshot(snapshot(5));
    store.events([event(5, "touch")]);
    store.reset();
    expect(store.read().events).toEqual([]);
    expect(store.series.length).toBe(0);
  });
});

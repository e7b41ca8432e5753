import { describe, expect, it, vi } from "vitest";
import type { MissionEvent, MissionSnapshot, Run } from "../api/types";
import { refusalOf } from "../api/refusal";
import { RecordedSource } from "./recorded-source";
import type { ReplayEvents } from "./replay-session";
import type { Sink } from "./source";

const CONTACTS = [{ arm: "left", start: 3, end: 4, peak: 0.5, planned: true }];

const run = (more: object = {}): Run =>
  ({ id: "a", status: "finished", configuration: "published", seed: 7, duration: 9, config: { control: { period: 0.001 } }, outcome: { contacts: CONTACTS }, ...more }) as unknown as Run;

/** Idle until 5 s, then detumbling. */
const TABLE = {
  run_id: "a",
  columns: ["mission.tick", "mission.time", "mission.phase", "left.hand_force"].map((name) => ({ name, unit: "1" })),
  rows: [[0, 0, 0, 0], [5000, 5, 1, 0.2], [9000, 9, 1, 0.1]],
};

const EVENTS = [{ message: "Detumbling begins" } as MissionEvent];

function opened(first: Run = run()) {
  const replay = { show: vi.fn(), arrange: vi.fn(), takePicture: vi.fn(), close: vi.fn() };
  const listeners: ReplayEvents[] = [];
  const service = {
    readRun: vi.fn(() => Promise.resolve(first)),
    readTicks: vi.fn(() => Promise.resolve(TABLE)),
    readEvents: vi.fn(() => Promise.resolve(EVENTS)),
    replay: (_: string, events: ReplayEvents) => {
      listeners.push(events);
      return replay;
    },
  };
  const sink = { link: vi.fn(), run: vi.fn(), config: vi.fn(), alarms: vi.fn(), history: vi.fn(), snapshot: vi.fn(), touches: vi.fn(), scene: vi.fn(), ended: vi.fn(), hello: vi.fn(), events: vi.fn(), reset: vi.fn() } satisfies Sink;
  const source = new RecordedSource("a", service);
  return { source, sink, service, replay, listeners, end: source.open(sink) };
}

const told = (sink: ReturnType<typeof opened>["sink"]) =>
  vi.waitFor(() => {
    expect(sink.link).toHaveBeenLastCalledWith({ state: "stored" });
  });

describe("a stored run", () => {
  it("is told like a mission: run, samples, touches, events", async () => {
    const { sink } = opened();
    await told(sink);
    expect(sink.run).toHaveBeenCalledWith({ id: "a", title: "Run a, published, seed 7" });
    expect(sink.history.mock.calls[0]?.[0]).toMatchObject([{ time: 0 }, { time: 5, leftForce: 0.2 }, { time: 9 }]);
    expect(sink.touches).toHaveBeenCalledWith(CONTACTS);
    expect(sink.events).toHaveBeenCalledWith(EVENTS);
    expect(sink.config).toHaveBeenCalledWith(run().config);
  });

  it("opens a second before the first motion, and shows the moment of its playback", async () => {
    const { source, sink, replay, listeners } = opened();
    await told(sink);
    expect(source.playback.read()).toMatchObject({ time: 4, end: 9 });
    await vi.waitFor(() => {
      expect(replay.show).toHaveBeenLastCalledWith(4);
    });
    source.playback.seek(6);
    expect(replay.show).toHaveBeenLastCalledWith(6);
    const moment = { tick: 6000 } as MissionSnapshot;
    listeners[0]?.snapshot(moment);
    expect(sink.snapshot).toHaveBeenCalledWith(moment);
  });

  it("has a scene of its own, which anybody may arrange", async () => {
    const { source, sink, replay, listeners } = opened();
    await expect(source.scene.read()).rejects.toThrow("no scene yet");
    listeners[0]?.opened("./scene/playback/1/", { camera: "top", cameras: ["top", "hand"], layers: { trails: true, cage: true } });
    expect(sink.scene).toHaveBeenCalledWith("./scene/playback/1/");
    await source.scene.change({ layers: { trails: false } });
    expect(replay.arrange).toHaveBeenCalledWith({ layers: { trails: false } });
    expect(await source.scene.read()).toMatchObject({ camera: "top", layers: { trails: false, cage: true } });
    expect(source.scene.changeNeeds).toBeNull();
  });

  it("is read again while it is being recorded, and no longer", async () => {
    const { source, sink, service } = opened(run({ status: "running", duration: 5 }));
    await told(sink);
    expect(source.refreshPeriod).toBe(1000);
    service.readRun.mockResolvedValue(run());
    await source.refresh();
    expect(source.playback.read().end).toBe(9);
    expect(source.refreshPeriod).toBeNull();
  });

  it("is asked whether it still grows before its ticks and events are read: what is missing comes at the next look", async () => {
    const { source, sink, service } = opened(run({ status: "running", duration: 5 }));
    await told(sink);
    service.readTicks.mockClear();
    service.readEvents.mockClear();
    let answer: (stored: Run) => void = () => undefined;
    service.readRun.mockReturnValue(new Promise<Run>((resolve) => { answer = resolve; }));
    const reading = source.refresh();
    expect(service.readTicks).not.toHaveBeenCalled();
    expect(service.readEvents).not.toHaveBeenCalled();
    answer(run());
    await reading;
    expect(service.readTicks).toHaveBeenCalledOnce();
    expect(service.readEvents).toHaveBeenCalledOnce();
  });

  it("says why it cannot be shown", async () => {
    const { sink, service, listeners, source, end } = opened();
    await told(sink);
    listeners[0]?.ended("The connection to the service is lost; open the run again.");
    expect(sink.ended).toHaveBeenCalledWith(expect.stringContaining("lost"));
    end();
    service.readTicks.mockRejectedValue(refusalOf(404, { detail: "no such run" }));
    source.open(sink);
    await vi.waitFor(() => {
      expect(sink.ended).toHaveBeenLastCalledWith("no such run");
    });
  });

  it("is read finely where somebody looks closely", async () => {
    const { source, sink, service } = opened();
    await told(sink);
    await source.readRange({ from: 2, to: 3 });
    expect(service.readTicks).toHaveBeenLastCalledWith("a", expect.any(Number), { from: 2, to: 3 });
  });

  it("ends its replay when it is closed", async () => {
    const { source, sink, replay, end } = opened();
    await told(sink);
    end();
    expect(replay.close).toHaveBeenCalledTimes(1);
    replay.show.mockClear();
    source.playback.seek(8);
    expect(replay.show).not.toHaveBeenCalled();
  });
});

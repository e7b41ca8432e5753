import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { MissionEvent } from "../api/types";
import { waitBefore } from "./backoff";
import { LiveSource, type Socket } from "./live-source";
import type { Link, Sink } from "./source";

class FakeSocket implements Socket {
  onopen: (() => void) | null = null;
  onclose: (() => void) | null = null;
  onmessage: ((message: { data: unknown }) => void) | null = null;
  sent: string[] = [];
  closed = false;
  send(text: string): void {
    this.sent.push(text);
  }
  close(): void {
    this.closed = true;
  }
  tell(frame: object): void {
    this.onmessage?.({ data: JSON.stringify(frame) });
  }
}

function recordingSink() {
  const links: Link[] = [];
  const runs: string[] = [];
  const calls: string[] = [];
  const sink: Sink = {
    link: (link) => links.push(link),
    run: ({ id }) => runs.push(id),
    config: () => undefined,
    alarms: (alarms) => calls.push(`alarms ${alarms.length}`),
    history: (samples) => calls.push(`history ${samples.length}`),
    snapshot: (snapshot) => calls.push(`snapshot ${snapshot.tick}`),
    touches: () => undefined,
    scene: () => undefined,
    ended: (why) => calls.push(`ended ${why}`),
    events: (events) => calls.push(...events.map(({ message }) => `event ${message}`)),
    hello: (service, time, cutOff) => calls.push(`${service} at ${time}, cut off: ${cutOff?.run_id ?? "none"}`),
    reset: () => calls.push("reset"),
  };
  return { links, runs, calls, sink };
}

const emptyHistory = { run_id: "a", columns: [] as { name: string; unit: string }[], rows: [] as number[][] };

/** As the service stamps them: by default as late as their mission time. */
const snapshot = (tick: number, run_id = "a", service_time = tick / 1000, phase = "detumbling") => ({ type: "snapshot", tick, time: tick / 1000, run_id, service_time, phase });

function opened(isSeen: () => boolean = () => true) {
  const sockets: FakeSocket[] = [];
  const readHistory = vi.fn(() => Promise.resolve({ ...emptyHistory, rows: [[1]] }));
  const connect = (): Socket => {
    const socket = new FakeSocket();
    sockets.push(socket);
    return socket;
  };
  const readEvents = vi.fn((): Promise<MissionEvent[]> => Promise.resolve([]));
  const readTicks = vi.fn(() => Promise.resolve({ ...emptyHistory, rows: [[1], [2]] }));
  const recorded = recordingSink();
  const source = new LiveSource({ connect, isSeen, readHistory, readEvents, readTicks });
  const end = source.open(recorded.sink);
  sockets[0]?.onopen?.();
  return { ...recorded, sockets, source, readHistory, readEvents, readTicks, end };
}

describe("live telemetry", () => {
  beforeEach(() => {
    vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "setInterval", "clearInterval", "performance"] });
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("passes frames on in their order", () => {
    const { sockets, calls } = opened();
    sockets[0]?.tell({ type: "hello", service: "one", service_time: 0, cut_off: { run_id: "a", phase: "caging", time: 2 } });
    sockets[0]?.tell({ type: "history", ...emptyHistory });
    sockets[0]?.tell(snapshot(3));
    sockets[0]?.tell({ type: "event", message: "touch" });
    expect(calls).toEqual(["one at 0, cut off: a", "history 0", "snapshot 3", "event touch"]);
  });

  it("shows one run whole until the first snapshot of the next one", () => {
    const { sockets, calls } = opened();
    sockets[0]?.tell(snapshot(900));
    sockets[0]?.tell({ type: "reset", run_id: "b" });
    sockets[0]?.tell({ type: "event", message: "of b" });
    sockets[0]?.tell(snapshot(901, "a", 0.95)); // of the run that has ended
    expect(calls).toEqual(["snapshot 900"]);
    sockets[0]?.tell(snapshot(1, "b", 1));
    expect(calls).toEqual(["snapshot 900", "reset", "event of b", "snapshot 1"]);
  });

  it("never shows what is older than what it has shown; a fork goes back in ticks, not in time", () => {
    const { sockets, calls } = opened();
    sockets[0]?.tell(snapshot(931));
    sockets[0]?.tell(snapshot(900));
    sockets[0]?.tell(snapshot(500, "fork", 2));
    expect(calls).toEqual(["snapshot 931", "reset", "snapshot 500"]);
  });

  it("forgets the old run before it takes the history of the one that a restarted service flies", () => {
    const { sockets, calls } = opened();
    sockets[0]?.tell(snapshot(900));
    sockets[0]?.onclose?.();
    vi.advanceTimersByTime(400);
    sockets[1]?.onopen?.();
    sockets[1]?.tell({ type: "history", ...emptyHistory, run_id: "b", rows: [[1], [2]] });
    sockets[1]?.tell(snapshot(3, "b"));
    expect(calls).toEqual(["snapshot 900", "reset", "history 2", "snapshot 3"]);
  });

  it("asks for the past of a fork, which begins in the middle", async () => {
    const { sockets, calls, readHistory } = opened();
    readHistory.mockResolvedValue({ ...emptyHistory, run_id: "fork", rows: [[1]] });
    sockets[0]?.tell(snapshot(900));
    vi.advanceTimersByTime(1000);
    sockets[0]?.tell({ type: "reset", run_id: "fork" });
    sockets[0]?.tell(snapshot(500, "fork", 2));
    await vi.waitFor(() => {
      expect(calls).toEqual(["snapshot 900", "reset", "snapshot 500", "history 1"]);
    });
    expect(readHistory).toHaveBeenCalledWith(-1);
  });

  it("names the run that it tells of", () => {
    const { sockets, runs } = opened();
    sockets[0]?.tell(snapshot(900));
    sockets[0]?.tell(snapshot(1, "b", 2));
    expect(runs).toEqual(["a", "b"]);
  });

  it("reads the events of the run from the library: when it joins, and when it missed some", async () => {
    const { sockets, calls, readEvents } = opened();
    readEvents.mockResolvedValueOnce([{ message: "before" } as MissionEvent]);
    sockets[0]?.tell(snapshot(900));
    await vi.waitFor(() => {
      expect(calls).toContain("event before");
    });
    sockets[0]?.tell(snapshot(901));
    expect(readEvents).toHaveBeenCalledExactlyOnceWith("a");
    sockets[0]?.tell({ type: "missed", events: 3 });
    sockets[0]?.tell(snapshot(902));
    expect(readEvents).toHaveBeenCalledTimes(2);
  });
});

describe("what is asked of a live source", () => {
  it("takes the extremes since those it knows, of this run only", async () => {
    const { sockets, source, calls, readHistory } = opened();
    await source.refresh(); // nothing is told yet
    expect(readHistory).not.toHaveBeenCalled();
    sockets[0]?.tell(snapshot(10));
    readHistory.mockResolvedValueOnce({ run_id: "a", columns: [{ name: "mission.tick", unit: "1" }], rows: [[4], [8]] });
    await source.refresh();
    expect(readHistory).toHaveBeenLastCalledWith(-1);
    expect(calls.at(-1)).toBe("history 2");
    readHistory.mockResolvedValueOnce({ run_id: "another", columns: [], rows: [[1]] });
    await source.refresh();
    expect(readHistory).toHaveBeenLastCalledWith(8);
    expect(calls.at(-1)).toBe("history 2");
  });

  it("reads a stretch once it is on disk", async () => {
    const { sockets, source, readTicks } = opened();
    sockets[0]?.tell(snapshot(10_000));
    expect(await source.readRange({ from: 7, to: 9 })).toBeNull();
    expect(await source.readRange({ from: 5, to: 7 })).toHaveLength(2);
    expect(readTicks).toHaveBeenCalledExactlyOnceWith("a", expect.any(Number), { from: 5, to: 7 });
  });

  it("always shows the present", () => {
    expect(opened().source.playback).toBeNull();
  });
});

describe("a connection", () => {
  beforeEach(() => {
    vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "setInterval", "clearInterval", "performance"] });
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("connects again after a loss, and after silence", () => {
    const { sockets, links } = opened();
    sockets[0]?.onclose?.();
    expect(links.at(-1)).toMatchObject({ state: "lost", attempt: 1 });
    vi.advanceTimersByTime(400);
    expect(sockets).toHaveLength(2);
    sockets[1]?.onopen?.();
    vi.advanceTimersByTime(3500);
    expect(links.at(-1)?.state).toBe("lost");
    expect(sockets[1]?.closed).toBe(true);
  });

  it("ends for good", () => {
    const { sockets, end } = opened();
    end();
    vi.advanceTimersByTime(60_000);
    expect(sockets).toHaveLength(1);
    expect(sockets[0]?.closed).toBe(true);
  });

  it("asks the history for what lies in a gap", async () => {
    const { sockets, calls, readHistory } = opened();
    vi.advanceTimersByTime(1000);
    sockets[0]?.tell(snapshot(10));
    sockets[0]?.tell(snapshot(2500));
    expect(readHistory).toHaveBeenCalledExactlyOnceWith(10);
    await vi.waitFor(() => {
      expect(calls).toContain("history 1");
    });
  });

  it("does not take an old mission's history for the new one's", async () => {
    const { sockets, calls } = opened();
    vi.advanceTimersByTime(1000);
    sockets[0]?.tell(snapshot(10));
    sockets[0]?.tell(snapshot(2500));
    sockets[0]?.tell({ type: "reset", run_id: "next" });
    sockets[0]?.tell(snapshot(1, "next", 3));
    await Promise.resolve();
    await Promise.resolve();
    expect(calls.at(-1)).toBe("snapshot 1");
  });

  it("acknowledges each snapshot, so that the next one sent is the newest there is", () => {
    const { sockets } = opened();
    for (const tick of [7, 8, 8]) sockets[0]?.tell(snapshot(tick));
    expect(sockets[0]?.sent).toEqual([7, 8, 8].map((tick) => JSON.stringify({ type: "ack", tick })));
  });
});

describe("the rate of snapshots", () => {
  beforeEach(() => {
    vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "setInterval", "clearInterval", "performance"] });
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  const rates = (socket: FakeSocket | undefined): number[] => (socket?.sent ?? []).map((text) => JSON.parse(text) as { rate?: number }).flatMap(({ rate }) => rate ?? []);

  it("is low while nothing moves, and full from the first motion on", () => {
    const { sockets } = opened();
    for (const [tick, phase] of [[1, "idle"], [2, "idle"], [3, "detumbling"], [4, "holding"], [5, "stopped"]] as const) sockets[0]?.tell(snapshot(tick, "a", tick, phase));
    expect(rates(sockets[0])).toEqual([10, 60, 10]);
  });

  it("is lowest while nobody sees the page; what was left out then is read when somebody does", () => {
    let seen = true;
    const { sockets, readHistory } = opened(() => seen);
    vi.advanceTimersByTime(1000);
    sockets[0]?.tell(snapshot(10, "a", 1));
    seen = false;
    sockets[0]?.tell(snapshot(20, "a", 2));
    sockets[0]?.tell(snapshot(2500, "a", 3));
    expect(readHistory).not.toHaveBeenCalled();
    seen = true;
    sockets[0]?.tell(snapshot(2510, "a", 4));
    expect(readHistory).toHaveBeenCalledExactlyOnceWith(20);
    expect(rates(sockets[0])).toEqual([4, 60]);
  });
});

describe("waiting between attempts", () => {
  it("grows, stays bounded and is spread", () => {
    expect(waitBefore(1, () => 0.5)).toBe(250);
    expect(waitBefore(4, () => 0.5)).toBe(2000);
    expect(waitBefore(50, () => 1)).toBeLessThanOrEqual(4800);
    expect(waitBefore(3, () => 0)).toBeLessThan(waitBefore(3, () => 0.9));
  });
});

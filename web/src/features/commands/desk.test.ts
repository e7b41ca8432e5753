import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { noAnswer, refusalOf } from "../../api/refusal";
import type { Arming, CommandAnswer } from "../../api/types";
import { ARMED_TIME, CommandDesk, DOUBLE_CLICK } from "./desk";

const answer: CommandAnswer = { id: "c", command: "capture", accepted: true, phase: "detumbling", tick: 1, time: 0, message: "begins" };
const never = () => Promise.reject(new Error("not expected"));

const MOVES = { words: "The robot will move.", byService: false };
const ROBOT_MOVES = { ...MOVES, byService: true };
const arming: Arming = { token: "t", command: "capture", expires_in: 6, message: "capture is armed" };

const deskWith = (service: Partial<Record<"send" | "arm", unknown>>): CommandDesk =>
  new CommandDesk({ send: never, arm: never, ...service } as ConstructorParameters<typeof CommandDesk>[0]);

describe("a command on its way", () => {
  it("waits, then shows what the service said", async () => {
    const desk = deskWith({ send: () => Promise.resolve(answer) });
    const sent = desk.send({ command: "capture" });
    expect(desk.read().waiting.has("capture")).toBe(true);
    expect(desk.read().answer?.verdict).toBe("waiting");
    await sent;
    expect(desk.read().waiting.size).toBe(0);
    expect(desk.read().answer).toMatchObject({ verdict: "accepted", words: "begins" });
  });

  it("shows the reason of a refusal", async () => {
    const refusal = refusalOf(409, { title: "Refused", detail: "hold it first", tip: "press Hold" });
    const desk = deskWith({ send: () => Promise.reject(refusal) });
    await desk.send({ command: "release" });
    expect(desk.read().answer).toMatchObject({ verdict: "refused", words: "hold it first", tip: "press Hold" });
  });

  it("is not yet carried out where the service says that it may be later", async () => {
    const detail = "method = published is being prepared (40 % compiled)";
    const desk = deskWith({ send: () => Promise.reject(refusalOf(503, { title: "Busy", detail, tip: "ask again then" })) });
    await desk.send({ command: "reset" });
    expect(desk.read().answer).toMatchObject({ verdict: "postponed", words: detail, tip: "ask again then" });
  });

  it("claims nothing when no answer came", async () => {
    const send = vi.fn(() => Promise.reject(noAnswer(new TypeError("failed to fetch"))));
    const desk = deskWith({ send });
    await desk.send({ command: "capture" });
    expect(desk.read().answer?.verdict).toBe("unknown");
    expect(send).toHaveBeenCalledTimes(1);
  });

  it("is sent once however often it is pressed", async () => {
    const send = vi.fn(() => Promise.resolve(answer));
    const desk = deskWith({ send });
    await Promise.all([desk.send({ command: "capture" }), desk.send({ command: "capture" })]);
    expect(send).toHaveBeenCalledTimes(1);
  });
});

describe("a command in two steps", () => {
  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("stays armed for a while only", () => {
    const desk = deskWith({});
    void desk.press({ command: "reset" }, MOVES);
    expect(desk.read()).toMatchObject({ armed: { order: "reset", token: null }, answer: { verdict: "armed", words: MOVES.words } });
    vi.advanceTimersByTime(ARMED_TIME - 1);
    expect(desk.read().armed).not.toBeNull();
    vi.advanceTimersByTime(1);
    expect(desk.read()).toMatchObject({ armed: null, answer: null });
  });

  it("goes at the second press, unless that is the end of a double click", async () => {
    const send = vi.fn(() => Promise.resolve(answer));
    const desk = deskWith({ send });
    void desk.press({ command: "capture" }, MOVES);
    vi.advanceTimersByTime(DOUBLE_CLICK - 1);
    void desk.press({ command: "capture" }, MOVES);
    expect(send).not.toHaveBeenCalled();
    vi.advanceTimersByTime(1);
    void desk.press({ command: "capture" }, MOVES);
    await vi.waitFor(() => {
      expect(desk.read().answer?.verdict).toBe("accepted");
    });
    expect(send).toHaveBeenCalledExactlyOnceWith({ command: "capture" });
    expect(desk.read().armed).toBeNull();
    void desk.press({ command: "hold" }, null);
    expect(send).toHaveBeenCalledTimes(2);
  });

  it("is armed no longer once anything else was ordered", async () => {
    const desk = deskWith({ send: () => Promise.resolve(answer) });
    await desk.arm({ command: "capture" }, MOVES);
    await desk.send({ command: "hold" });
    expect(desk.read().armed).toBeNull();
    await desk.arm({ command: "capture" }, MOVES);
    desk.explain("cage", "not now");
    expect(desk.read().armed).toBeNull();
    await desk.arm({ command: "capture" }, MOVES);
    await desk.arm({ command: "release" }, MOVES);
    expect(desk.read().armed?.order).toBe("release");
  });
});

describe("a command that the service arms", () => {
  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("brings what the service gave for it, for as long as the service says", async () => {
    const send = vi.fn(() => Promise.resolve(answer));
    const arm = vi.fn(() => Promise.resolve(arming));
    const desk = deskWith({ send, arm });
    const request = { command: "reset", configuration: "testbed", changes: { a: 1 } } as const;
    await desk.arm(request, ROBOT_MOVES);
    expect(arm).toHaveBeenCalledExactlyOnceWith(request);
    vi.advanceTimersByTime(1000 * arming.expires_in - 1);
    void desk.press(request, ROBOT_MOVES);
    expect(send).toHaveBeenCalledExactlyOnceWith({ ...request, arming: "t" });
    await desk.arm({ command: "capture" }, ROBOT_MOVES);
    vi.advanceTimersByTime(1000 * arming.expires_in);
    expect(desk.read().armed).toBeNull();
  });

  it("is not armed by a refusal, nor by no answer", async () => {
    for (const cause of [refusalOf(409, { detail: "not in this phase" }), noAnswer(new TypeError("failed to fetch"))]) {
      const desk = deskWith({ arm: () => Promise.reject(cause) });
      await desk.arm({ command: "capture" }, ROBOT_MOVES);
      expect(desk.read()).toMatchObject({ armed: null, answer: { words: cause.message } });
      expect(desk.read().waiting.size).toBe(0);
    }
  });

  it("follows the service, which takes it back after a STOP or with another phase", async () => {
    const desk = deskWith({ arm: () => Promise.resolve(arming) });
    const told = { command: "capture", by: "ana", expires_in: 5 } as const;
    await desk.arm({ command: "capture" }, ROBOT_MOVES);
    desk.followService(null); // a snapshot from before it was armed
    expect(desk.read().armed).not.toBeNull();
    desk.followService(told);
    expect(desk.read().armed).not.toBeNull();
    desk.followService(null);
    expect(desk.read().armed).toBeNull();
    await desk.arm({ command: "reset" }, MOVES);
    desk.followService(null); // what only the page asks twice about is none of the service's
    expect(desk.read().armed?.order).toBe("reset");
  });
});

import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { noAnswer, refusalOf } from "../../api/refusal";
import type { CommandAnswer } from "../../api/types";
import { ARMED_TIME, CommandDesk, DOUBLE_CLICK } from "./desk";

const answer: CommandAnswer = { id: "c", command: "capture", accepted: true, phase: "detumbling", tick: 1, time: 0, message: "begins" };
const never = () => Promise.reject(new Error("not expected"));

describe("a command on its way", () => {
  it("waits, then shows what the service said", async () => {
    const desk = new CommandDesk({ send: () => Promise.resolve(answer), stop: never });
    const sent = desk.send({ command: "capture" });
    expect(desk.read().waiting.has("capture")).toBe(true);
    expect(desk.read().answer?.verdict).toBe("waiting");
    await sent;
    expect(desk.read().waiting.size).toBe(0);
    expect(desk.read().answer).toMatchObject({ verdict: "accepted", words: "begins" });
  });

  it("shows the reason of a refusal", async () => {
    const refusal = refusalOf(409, { title: "Refused", detail: "hold it first", tip: "press Hold" });
    const desk = new CommandDesk({ send: () => Promise.reject(refusal), stop: never });
    await desk.send({ command: "release" });
    expect(desk.read().answer).toMatchObject({ verdict: "refused", words: "hold it first", tip: "press Hold" });
  });

  it("claims nothing when no answer came", async () => {
    const send = vi.fn(() => Promise.reject(noAnswer(new TypeError("failed to fetch"))));
    const desk = new CommandDesk({ send, stop: never });
    await desk.send({ command: "capture" });
    expect(desk.read().answer?.verdict).toBe("unknown");
    expect(send).toHaveBeenCalledTimes(1);
  });

  it("is sent once however often it is pressed", async () => {
    const send = vi.fn(() => Promise.resolve(answer));
    const desk = new CommandDesk({ send, stop: never });
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
    const desk = new CommandDesk({ send: never, stop: never });
    desk.arm("capture", "The robot will move.");
    expect(desk.read()).toMatchObject({ armed: "capture", answer: { verdict: "armed", words: "The robot will move." } });
    vi.advanceTimersByTime(ARMED_TIME - 1);
    expect(desk.read().armed).toBe("capture");
    vi.advanceTimersByTime(1);
    expect(desk.read()).toMatchObject({ armed: null, answer: null });
  });

  it("goes at the second press, unless that is the end of a double click", async () => {
    const send = vi.fn(() => Promise.resolve(answer));
    const desk = new CommandDesk({ send, stop: never });
    desk.press({ command: "capture" }, "The robot will move.");
    vi.advanceTimersByTime(DOUBLE_CLICK - 1);
    desk.press({ command: "capture" }, "The robot will move.");
    expect(send).not.toHaveBeenCalled();
    vi.advanceTimersByTime(1);
    desk.press({ command: "capture" }, "The robot will move.");
    await vi.waitFor(() => {
      expect(desk.read().answer?.verdict).toBe("accepted");
    });
    expect(send).toHaveBeenCalledExactlyOnceWith({ command: "capture" });
    expect(desk.read().armed).toBeNull();
    desk.press({ command: "hold" }, null);
    expect(send).toHaveBeenCalledTimes(2);
  });

  it("is armed no longer once anything else was ordered, or STOP", async () => {
    const desk = new CommandDesk({ send: () => Promise.resolve(answer), stop: () => Promise.resolve(answer) });
    for (const other of [() => desk.send({ command: "hold" }), () => desk.stop()]) {
      desk.arm("capture", "The robot will move.");
      await other();
      expect(desk.read().armed).toBeNull();
    }
    desk.arm("capture", "");
    desk.explain("cage", "not now");
    expect(desk.read().armed).toBeNull();
    desk.arm("capture", "");
    desk.arm("release", "");
    expect(desk.read().armed).toBe("release");
  });
});

describe("STOP", () => {
  it("is sent again until it is answered, but not for ever", async () => {
    const stop = vi.fn(() => Promise.reject(noAnswer(new TypeError("failed to fetch"))));
    const desk = new CommandDesk({ send: never, stop });
    await desk.stop();
    expect(stop).toHaveBeenCalledTimes(3);
    expect(desk.read().stop?.verdict).toBe("unknown");
  });

  it("does not wait for a command that is under way", async () => {
    const desk = new CommandDesk({ send: () => new Promise(() => undefined), stop: () => Promise.resolve(answer) });
    void desk.send({ command: "capture" });
    await desk.stop();
    expect(desk.read().stop?.verdict).toBe("accepted");
  });
});

import { describe, expect, it, vi } from "vitest";
import { isStopKey } from "./key";
import { transformIn } from "./place";
import { sendStop } from "./send";

const answer = (status: number, body: unknown) => () => Promise.resolve(Response.json(body, { status }));

describe("STOP", () => {
  it("is stopped when the service says so, and sent once", async () => {
    const send = vi.fn(answer(200, { accepted: true, message: "stopped" }));
    expect(await sendStop(send)).toMatchObject({ kind: "stopped", title: "Stopped" });
    expect(send).toHaveBeenCalledTimes(1);
  });

  it.each([
    ["a page of a proxy", () => Promise.resolve(new Response("<!doctype html>Sign in"))],
    ["an answer of another shape", answer(200, ["accepted"])],
    ["nothing at all", answer(200, null)],
    ["a refusal in an answer", answer(200, { accepted: false })],
    ["a service that fails", answer(504, { detail: "the loop is silent" })],
    ["a service that is away", () => Promise.reject(new TypeError("failed to fetch"))],
    ["a service that hangs", () => Promise.reject(new DOMException("no answer in time", "TimeoutError"))],
  ])("is not confirmed by %s, and sent again, but not for ever", async (_, respond: () => Promise<Response>) => {
    const send = vi.fn(respond);
    const verdict = await sendStop(send);
    expect(verdict).toMatchObject({ kind: "unconfirmed", title: "Not confirmed" });
    expect(verdict.advice).toContain("stop the robot itself");
    expect(send).toHaveBeenCalledTimes(3);
  });

  it("is confirmed by a later try", async () => {
    const replies = [answer(503, null), answer(200, { accepted: true })];
    expect(await sendStop(() => (replies.shift() ?? answer(500, null))())).toMatchObject({ kind: "stopped" });
  });

  it("says who refused it, and what to do then", async () => {
    const send = vi.fn(answer(401, { detail: "no token" }));
    const verdict = await sendStop(send);
    expect(verdict).toMatchObject({ kind: "refused", advice: "Sign in, or stop the robot itself." });
    expect(verdict.title).toContain("Not signed in");
    expect(send).toHaveBeenCalledTimes(1);
    expect((await sendStop(answer(403, { detail: "the Origin is another one" }))).advice).toContain("the Origin is another one");
    expect((await sendStop(answer(429, "odd"))).advice).toContain("answered 429");
  });
});

describe("the key that stops", () => {
  it("is Escape, once however long it is held", () => {
    expect(isStopKey({ key: "Escape", repeat: false })).toBe(true);
    expect(isStopKey({ key: "Escape", repeat: true })).toBe(false);
    expect(isStopKey({ key: "e", repeat: false })).toBe(false);
  });
});

describe("STOP under fingers that zoom", () => {
  it("stands in the corner of what is seen, at its own size", () => {
    expect(transformIn({ offsetLeft: 0, offsetTop: 0, width: 1000, scale: 1 }, 1000)).toBe("");
    const zoomed = { offsetLeft: 100, offsetTop: 50, width: 500, scale: 2 };
    expect(transformIn(zoomed, 1000)).toBe("translate(-400.00px, 50.00px) scale(0.5000)");
  });
});

import { describe, expect, it, vi } from "vitest";
import { Refusal } from "../../api/refusal";
import type { FuturesChoice, RehearsalDetail, RehearsalRequest } from "../../api/types";
import { RehearsalDesk } from "./desk";

const REQUEST: RehearsalRequest = { source: "live", changes: {}, request: "capture", futures: 2, seed: 0, horizon: 20, uncertainty: {}, asker: "page" };

const detailOf = (id: string, status: RehearsalDetail["status"], request: string | null = "capture"): RehearsalDetail =>
  ({ id, status, progress: { done: 1, total: 2, wall_time: 0.1 }, note: null, request, result: status === "finished" ? { request, changes: {}, as_changed: null } : null }) as unknown as RehearsalDetail;

/** A service that answers reads in this order; each wait ends at once. */
function serviceWith(started: RehearsalDetail | Refusal, reads: (RehearsalDetail | Refusal)[] = []) {
  const answer = (what: RehearsalDetail | Refusal | undefined): Promise<RehearsalDetail> => (what === undefined || what instanceof Refusal ? Promise.reject(what ?? new Error("no further answer")) : Promise.resolve(what));
  return {
    start: () => answer(started),
    read: () => answer(reads.shift()),
    cancel: (id: string) => Promise.resolve(detailOf(id, "cancelled")),
    draw: vi.fn<(choice: FuturesChoice) => Promise<void>>().mockResolvedValue(),
    erase: vi.fn<() => Promise<void>>().mockResolvedValue(),
    wait: () => Promise.resolve(),
  };
}

describe("rehearsals of a page", () => {
  it("follow one to its end", async () => {
    const desk = new RehearsalDesk(serviceWith(detailOf("a", "queued"), [detailOf("a", "running"), detailOf("a", "finished")]));
    await desk.rehearse(REQUEST, "run 1");
    const view = desk.read();
    expect(view.finished?.detail.id).toBe("a");
    expect(view.plotted).toBe(true);
  });

  it("go on with a service that did not answer in between", async () => {
    const silence = new Refusal(0, "No answer", "The service cannot be reached.", "", []);
    const desk = new RehearsalDesk(serviceWith(detailOf("a", "running"), [silence, silence, detailOf("a", "finished")]));
    await desk.rehearse(REQUEST, "run 1");
    expect(desk.read().refusal).toBeNull();
    expect(desk.read().finished?.detail.id).toBe("a");
  });

  it("say why one was not begun, and leave the last one as it is", async () => {
    const service = serviceWith(detailOf("a", "finished"));
    const desk = new RehearsalDesk(service);
    await desk.rehearse(REQUEST, "run 1");
    service.start = () => Promise.reject(new Refusal(409, "Refused", "a hand touches the target", "wait", []));
    await desk.rehearse(REQUEST, "run 1");
    expect(desk.read().refusal?.message).toBe("a hand touches the target");
    expect(desk.read().finished?.detail.id).toBe("a");
  });

  it("keep one that was superseded from being taken for a result", async () => {
    const desk = new RehearsalDesk(serviceWith(detailOf("a", "running"), [detailOf("a", "superseded")]));
    await desk.rehearse(REQUEST, "run 1");
    expect(desk.read().detail?.status).toBe("superseded");
    expect(desk.read().finished).toBeNull();
  });

  it("are drawn in the scene, until they are dismissed; a scene that cannot loses nothing of them", async () => {
    const service = serviceWith(detailOf("a", "finished"));
    service.draw.mockRejectedValue(new Refusal(409, "Refused", "no scene", "", []));
    const desk = new RehearsalDesk(service);
    await desk.rehearse(REQUEST, "run 1");
    expect(service.draw).toHaveBeenCalledWith({ rehearsal: "a", case: "as_it_is" });
    expect(desk.read().finished?.detail.id).toBe("a");
    expect(service.erase).not.toHaveBeenCalled();
    desk.dismiss();
    expect(service.erase).toHaveBeenCalledOnce();
  });

  it("look at the newest alone", async () => {
    const service = serviceWith(detailOf("old", "running"), [detailOf("new", "finished")]);
    let release: (detail: RehearsalDetail) => void = () => undefined;
    service.start = () => new Promise((resolve) => { release = resolve; });
    const desk = new RehearsalDesk(service);
    const old = desk.rehearse(REQUEST, "run 1");
    service.start = () => Promise.resolve(detailOf("new", "running"));
    await desk.rehearse(REQUEST, "run 1");
    release(detailOf("old", "finished"));
    await old;
    expect(desk.read().finished?.detail.id).toBe("new");
  });
});

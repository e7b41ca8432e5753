/** Commands on their way: waiting, then what the service said. Nothing is assumed, nothing is queued. */
import { Refusal } from "../../api/refusal";
import { sendCommand, stopMission } from "../../api/service";
import type { Command, CommandAnswer, CommandRequest } from "../../api/types";

export type Order = Command | "stop";

/** `unknown`: no answer came, so whether it was done cannot be told. */
export type Verdict = "armed" | "waiting" | "accepted" | "refused" | "unknown";

/** `armed`: pressed once, of two times that it takes. */
export interface Answer {
  readonly order: Order;
  readonly verdict: Verdict;
  readonly words: string;
  readonly tip: string;
}

export interface DeskView {
  /** The orders whose answers are outstanding. */
  readonly waiting: ReadonlySet<Order>;
  /** The latest answer to a command. */
  readonly answer: Answer | null;
  /** The order that the next press gives, if it comes soon. */
  readonly armed: Order | null;
  /** The latest answer to STOP, which has a place of its own. */
  readonly stop: Answer | null;
}

/** STOP may be sent again without harm; any other command may not. */
const STOP_TRIES = 3;

/** Milliseconds for which an order stays armed. */
export const ARMED_TIME = 6000;

/** Milliseconds after arming in which a press is the second half of a double click, and no decision. */
export const DOUBLE_CLICK = 400;

interface Service {
  readonly send: (request: CommandRequest) => Promise<CommandAnswer>;
  readonly stop: () => Promise<CommandAnswer>;
}

export class CommandDesk {
  private view: DeskView = { waiting: new Set(), answer: null, armed: null, stop: null };
  private readonly listeners = new Set<() => void>();
  private armedAt = 0;
  private disarming: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly service: Service = { send: sendCommand, stop: stopMission }) {}

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  readonly read = (): DeskView => this.view;

  /** Sends a command once; a second press while its answer is outstanding does nothing. */
  async send(request: CommandRequest): Promise<void> {
    const order = request.command;
    if (this.view.waiting.has(order)) return;
    this.disarm();
    this.change({ waiting: including(this.view.waiting, order), answer: waiting(order) });
    const answer = await this.service.send(request).then(accepted(order), refused(order));
    this.change({ waiting: without(this.view.waiting, order), answer });
  }

  /** A press of a button: sends its command, at once or, where `arming` says what it will do, at the second press. */
  press(request: CommandRequest, arming: string | null): void {
    const order = request.command;
    if (arming === null) void this.send(request);
    else if (this.view.armed !== order) this.arm(order, arming);
    else if (performance.now() - this.armedAt >= DOUBLE_CLICK) void this.send(request);
  }

  /** The first of two presses: says what the second one will do, and takes itself back after a while. */
  arm(order: Order, words: string): void {
    this.disarm();
    this.armedAt = performance.now();
    this.change({ armed: order, answer: { order, verdict: "armed", words, tip: "" } });
    this.disarming = setTimeout(() => {
      this.disarm();
    }, ARMED_TIME);
  }

  /** The next press gives no order: somebody has looked elsewhere, or too long. */
  disarm(): void {
    clearTimeout(this.disarming);
    if (this.view.armed === null) return;
    const answer = this.view.answer?.verdict === "armed" ? null : this.view.answer;
    this.change({ armed: null, answer });
  }

  async stop(): Promise<void> {
    this.disarm();
    this.change({ waiting: including(this.view.waiting, "stop"), stop: waiting("stop") });
    let answer = waiting("stop");
    for (let attempt = 0; attempt < STOP_TRIES && answer.verdict !== "accepted"; attempt += 1) {
      answer = await this.service.stop().then(accepted("stop"), refused("stop"));
    }
    this.change({ waiting: without(this.view.waiting, "stop"), stop: answer });
  }

  /** Shows why a button that cannot be pressed cannot; for fingers, which do not hover. */
  explain(order: Order, reason: string): void {
    this.disarm();
    this.change({ answer: { order, verdict: "refused", words: reason, tip: "" } });
  }

  private change(change: Partial<DeskView>): void {
    this.view = { ...this.view, ...change };
    for (const listener of this.listeners) listener();
  }
}

const waiting = (order: Order): Answer => ({ order, verdict: "waiting", words: "", tip: "" });

const accepted =
  (order: Order) =>
  (answer: CommandAnswer): Answer => ({ order, verdict: "accepted", words: answer.message, tip: "" });

const refused =
  (order: Order) =>
  (cause: unknown): Answer => {
    if (!(cause instanceof Refusal)) throw cause;
    return { order, verdict: cause.decided ? "refused" : "unknown", words: cause.message, tip: cause.tip };
  };

const including = (orders: ReadonlySet<Order>, order: Order): ReadonlySet<Order> => new Set([...orders, order]);

const without = (orders: ReadonlySet<Order>, order: Order): ReadonlySet<Order> =>
  new Set([...orders].filter((other) => other !== order));

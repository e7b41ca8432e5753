/** Commands on their way: waiting, then what the service said. Nothing is assumed, nothing is queued. */
import { Refusal } from "../../api/refusal";
import { armCommand, sendCommand } from "../../api/service";
import type { Armed, Arming, ArmingRequest, Command, CommandAnswer, CommandRequest } from "../../api/types";

export type Order = Command;

/** `postponed`: it was not carried out, and may be later. `unknown`: no answer came, so nobody knows whether it was. */
export type Verdict = "armed" | "waiting" | "accepted" | "refused" | "postponed" | "unknown";

/** `armed`: pressed once, of two times that it takes. */
export interface Answer {
  readonly order: Order;
  readonly verdict: Verdict;
  readonly words: string;
  readonly tip: string;
}

/** An order that the next press of its button gives. */
export interface ArmedOrder {
  readonly order: Order;
  /** The command with its arguments; no other is armed. */
  readonly request: CommandRequest;
  /** What the service gave for it; null for what only this page asks twice about. */
  readonly token: string | null;
  /** When it is taken back, on the clock of `performance.now()`. */
  readonly until: number;
}

/** Why an order takes two presses. */
export interface Caution {
  /** What the second one will do. */
  readonly words: string;
  /** Whether the service has to arm it: a robot moves by nothing else. */
  readonly byService: boolean;
}

export interface DeskView {
  /** The orders whose answers are outstanding. */
  readonly waiting: ReadonlySet<Order>;
  /** The latest answer to a command. */
  readonly answer: Answer | null;
  /** The order that the next press gives, if it comes soon. */
  readonly armed: ArmedOrder | null;
}

/** Milliseconds for which an order stays armed that only this page asks twice about. */
export const ARMED_TIME = 6000;

/** Milliseconds after arming in which a press is the second half of a double click, and no decision. */
export const DOUBLE_CLICK = 400;

interface Service {
  readonly send: (request: CommandRequest) => Promise<CommandAnswer>;
  readonly arm: (request: ArmingRequest) => Promise<Arming>;
}

/** The part of a command that its arming names, too. */
const toBeArmed = ({ command, configuration, changes }: CommandRequest): ArmingRequest => ({
  command: command as ArmingRequest["command"],
  ...(configuration !== undefined && configuration !== null && { configuration }),
  ...(changes !== undefined && changes !== null && { changes }),
});

export class CommandDesk {
  private view: DeskView = { waiting: new Set(), answer: null, armed: null };
  private readonly listeners = new Set<() => void>();
  private armedAt = 0;
  /** Whether a snapshot has shown what the service armed; from then on it is armed for as long as they do. */
  private armedByService = false;
  private disarming: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly service: Service = { send: sendCommand, arm: armCommand }) {}

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  readonly read = (): DeskView => this.view;

  /** Sends a command once; a second press while its answer is outstanding does nothing. */
  async send(request: CommandRequest): Promise<Answer> {
    const order = request.command;
    if (this.view.waiting.has(order)) return waiting(order);
    this.disarm();
    this.change({ waiting: including(this.view.waiting, order), answer: waiting(order) });
    const answer = await this.service.send(request).then(accepted(order), refused(order));
    this.change({ waiting: without(this.view.waiting, order), answer });
    return answer;
  }

  /** A press of a button: sends its command, at once or, where there is need for caution, at the second press. */
  press(request: CommandRequest, caution: Caution | null): Promise<Answer> {
    const { armed } = this.view;
    if (caution === null) return this.send(request);
    if (armed === null || !isSame(armed.request, request)) return this.arm(request, caution);
    const tooSoon = performance.now() - this.armedAt < DOUBLE_CLICK;
    if (tooSoon) return Promise.resolve({ order: request.command, verdict: "armed", words: caution.words, tip: "" });
    return this.send({ ...request, ...(armed.token !== null && { arming: armed.token }) });
  }

  /** The first of two presses: says what the second one will do, and takes itself back after a while. */
  async arm(request: CommandRequest, { words, byService }: Caution): Promise<Answer> {
    const order = request.command;
    if (this.view.waiting.has(order)) return waiting(order);
    this.disarm();
    if (!byService) return this.hold(request, words, null, ARMED_TIME);
    this.change({ waiting: including(this.view.waiting, order), answer: waiting(order) });
    const arming = await this.service.arm(toBeArmed(request)).catch(refused(order));
    this.change({ waiting: without(this.view.waiting, order) });
    if (!("verdict" in arming)) return this.hold(request, words, arming.token, 1000 * arming.expires_in);
    this.change({ answer: arming });
    return arming;
  }

  /** The next press gives no order: somebody has looked elsewhere, or too long. */
  disarm(): void {
    clearTimeout(this.disarming);
    if (this.view.armed === null) return;
    const answer = this.view.answer?.verdict === "armed" ? null : this.view.answer;
    this.change({ armed: null, answer });
  }

  /** Follows what the service says is armed: after a STOP or another phase, nothing is. */
  followService(armed: Armed | null): void {
    const own = this.view.armed;
    if (typeof own?.token !== "string") return;
    if (armed?.command === own.order) this.armedByService = true;
    else if (this.armedByService) this.disarm();
  }

  /** Shows why a button that cannot be pressed cannot; for fingers, which do not hover. */
  explain(order: Order, reason: string): void {
    this.disarm();
    this.change({ answer: { order, verdict: "refused", words: reason, tip: "" } });
  }

  private hold(request: CommandRequest, words: string, token: string | null, time: number): Answer {
    const answer: Answer = { order: request.command, verdict: "armed", words, tip: "" };
    this.armedAt = performance.now();
    this.armedByService = false;
    this.change({ armed: { order: request.command, request, token, until: this.armedAt + time }, answer });
    this.disarming = setTimeout(() => {
      this.disarm();
    }, time);
    return answer;
  }

  private change(change: Partial<DeskView>): void {
    this.view = { ...this.view, ...change };
    for (const listener of this.listeners) listener();
  }
}

/** Whether both ask for the same with the same arguments. */
export const isSame = (one: CommandRequest, other: CommandRequest): boolean => JSON.stringify(one) === JSON.stringify(other);

const waiting = (order: Order): Answer => ({ order, verdict: "waiting", words: "", tip: "" });

const accepted =
  (order: Order) =>
  (answer: CommandAnswer): Answer => ({ order, verdict: "accepted", words: answer.message, tip: "" });

function verdictOf(refusal: Refusal): Verdict {
  if (refusal.postponed) return "postponed";
  return refusal.decided ? "refused" : "unknown";
}

const refused =
  (order: Order) =>
  (cause: unknown): Answer => {
    if (!(cause instanceof Refusal)) throw cause;
    return { order, verdict: verdictOf(cause), words: cause.message, tip: cause.tip };
  };

const including = (orders: ReadonlySet<Order>, order: Order): ReadonlySet<Order> => new Set([...orders, order]);

const without = (orders: ReadonlySet<Order>, order: Order): ReadonlySet<Order> =>
  new Set([...orders].filter((other) => other !== order));

/** Rehearsals of this page: the one that flies, and the last that has finished. */
import { Refusal } from "../../api/refusal";
import { cancelRehearsal, drawFutures, eraseFutures, readRehearsal, startRehearsal } from "../../api/service";
import type { FuturesChoice, RehearsalDetail, RehearsalRequest, RehearsalResult } from "../../api/types";

/** Milliseconds between two looks at one that flies. */
const LOOK_PERIOD = 250;
/** Milliseconds until a service that did not answer is asked again. */
const PATIENCE = 1000;

/** One that has finished. */
export interface Finished {
  readonly detail: RehearsalDetail;
  readonly result: RehearsalResult;
  /** The run that was flown when it was asked for. */
  readonly run: string;
}

export interface RehearsalView {
  /** Asked for, and not yet answered. */
  readonly asking: boolean;
  /** The newest, from the answer on. */
  readonly detail: RehearsalDetail | null;
  /** Why the newest was not begun, or is known no more. */
  readonly refusal: Refusal | null;
  /** The last that has finished; it stays while the next one flies. */
  readonly finished: Finished | null;
  /** Whether plots show what was predicted for the run. */
  readonly plotted: boolean;
}

interface Service {
  readonly start: (request: RehearsalRequest) => Promise<RehearsalDetail>;
  readonly read: (id: string) => Promise<RehearsalDetail>;
  readonly cancel: (id: string) => Promise<RehearsalDetail>;
  readonly draw: (choice: FuturesChoice) => Promise<void>;
  readonly erase: () => Promise<void>;
  readonly wait: (milliseconds: number) => Promise<void>;
}

const SERVICE: Service = {
  start: startRehearsal,
  read: readRehearsal,
  cancel: cancelRehearsal,
  draw: drawFutures,
  erase: eraseFutures,
  wait: (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds)),
};

/** Where the scene shows something else than the live mission. */
const UNSEEN: Service = { ...SERVICE, draw: () => Promise.resolve(), erase: () => Promise.resolve() };

export const isFlying = ({ status }: RehearsalDetail): boolean => status === "queued" || status === "running";

const NOTHING: RehearsalView = { asking: false, detail: null, refusal: null, finished: null, plotted: false };

export class RehearsalDesk {
  private view = NOTHING;
  private readonly listeners = new Set<() => void>();
  /** Counts requests: the answers to an older one are not looked at. */
  private newest = 0;

  constructor(private readonly service: Service = SERVICE) {}

  /** Of stored moments, of which the live scene shows nothing. */
  static readonly unseen = (): RehearsalDesk => new RehearsalDesk(UNSEEN);

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  readonly read = (): RehearsalView => this.view;

  /** Asks for a rehearsal of that run and follows it to its end; the newest takes the place of an older one. */
  async rehearse(request: RehearsalRequest, run: string): Promise<void> {
    this.newest += 1;
    const number = this.newest;
    this.change({ asking: true, refusal: null, detail: null });
    try {
      let detail = await this.service.start(request);
      while (number === this.newest) {
        this.look(detail, run);
        if (!isFlying(detail)) return;
        await this.service.wait(LOOK_PERIOD);
        detail = await this.readAgain(detail.id, number);
      }
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      if (number === this.newest) this.change({ asking: false, refusal: cause, detail: null });
    }
  }

  /** Ends the one that flies. @throws Refusal */
  async cancel(): Promise<void> {
    const { detail } = this.view;
    if (detail === null || !isFlying(detail)) return;
    const number = this.newest;
    const cancelled = await this.service.cancel(detail.id);
    if (number === this.newest) this.change({ detail: cancelled });
  }

  /** Takes away what the last one said, also from the plots; the service keeps what was foreseen of a run. */
  readonly dismiss = (): void => {
    this.change({ finished: null, detail: null, refusal: null, plotted: false });
    void this.inScene(this.service.erase());
  };

  readonly plot = (plotted: boolean): void => {
    this.change({ plotted });
  };

  private look(detail: RehearsalDetail, run: string): void {
    const { result } = detail;
    if (detail.status !== "finished" || result === null) {
      this.change({ asking: false, detail });
      return;
    }
    const finished: Finished = { detail: { ...detail, result: null }, result, run };
    this.change({ asking: false, detail: finished.detail, finished, plotted: true });
    const choice: FuturesChoice = { rehearsal: detail.id, case: result.as_changed === null ? "as_it_is" : "as_changed" };
    void this.inScene(this.service.draw(choice));
  }

  /** The scene shows it as well; where it cannot, nothing of the rehearsal is lost. */
  private async inScene(drawn: Promise<void>): Promise<void> {
    try {
      await drawn;
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
    }
  }

  /** Whoever does not answer now may answer later. */
  private async readAgain(id: string, number: number): Promise<RehearsalDetail> {
    for (;;) {
      try {
        return await this.service.read(id);
      } catch (cause) {
        if (!(cause instanceof Refusal) || cause.decided || number !== this.newest) throw cause;
        await this.service.wait(PATIENCE);
      }
    }
  }

  private change(change: Partial<RehearsalView>): void {
    this.view = { ...this.view, ...change };
    for (const listener of this.listeners) listener();
  }
}

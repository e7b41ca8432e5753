/** A stored run replayed by the service: moments asked for, snapshots told, and a scene of its own. */
import { addressOf, socketAddress } from "../api/address";
import type { MissionSnapshot, SceneChange, SceneView } from "../api/types";
import type { PictureRequest } from "./source";

interface Opened extends SceneView {
  /** A path of the service. */
  readonly scene: `/${string}`;
}

type Frame =
  | ({ type: "opened" } & Opened)
  | ({ type: "snapshot" } & MissionSnapshot)
  | { type: "refused"; problem: { detail: string; tip: string } }
  | { type: "invalid"; detail: string };

export interface ReplayEvents {
  readonly opened: (address: string, view: SceneView) => void;
  readonly snapshot: (snapshot: MissionSnapshot) => void;
  /** It cannot be shown, or not any more, and why. */
  readonly ended: (why: string) => void;
}

/** What a source needs of a session. */
export interface Replay {
  /** Asks for a moment [s]; while one is on its way only the latest is kept. */
  show(time: number): void;
  arrange(change: SceneChange): void;
  /** Has the scene draw a picture of a moment; likewise, and before any moment that is asked for. */
  takePicture(request: PictureRequest): void;
  close(): void;
}

export class ReplaySession implements Replay {
  private readonly socket: WebSocket;
  private wanted: number | null = null;
  private picture: PictureRequest | null = null;
  private waiting = true;
  private refusal = "";

  constructor(run: string, events: ReplayEvents) {
    this.socket = new WebSocket(socketAddress(`/api/v1/runs/${encodeURIComponent(run)}/playback`));
    this.socket.onmessage = (message) => {
      this.take(JSON.parse(String(message.data)) as Frame, events);
    };
    this.socket.onclose = () => {
      events.ended(this.refusal || "The connection to the service is lost; open the run again.");
    };
  }

  show(time: number): void {
    this.wanted = time;
    this.ask();
  }

  arrange(change: SceneChange): void {
    this.socket.send(JSON.stringify({ type: "arrange", ...change }));
  }

  takePicture(request: PictureRequest): void {
    this.picture = request;
    this.ask();
  }

  close(): void {
    this.socket.onclose = this.socket.onmessage = null;
    this.socket.close();
  }

  private ask(): void {
    if (this.waiting) return;
    if (this.picture !== null) {
      this.socket.send(JSON.stringify({ type: "picture", ...this.picture }));
      this.picture = null;
    } else if (this.wanted !== null) {
      this.socket.send(JSON.stringify({ type: "show", time: this.wanted }));
      this.wanted = null;
    } else return;
    this.waiting = true;
  }

  private take(frame: Frame, events: ReplayEvents): void {
    if (frame.type === "refused") this.refusal = `${frame.problem.detail}. ${frame.problem.tip}`;
    if (frame.type === "opened") {
      const { scene, camera, cameras, layers } = frame;
      events.opened(addressOf(scene), { camera, cameras, layers });
    }
    if (frame.type === "snapshot") events.snapshot(frame);
    this.waiting = false;
    this.ask();
  }
}

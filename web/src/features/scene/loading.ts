/** How far a scene is on its way to a picture, as its frame reports it (server/scene_page.py). */
import { useEffect, useState } from "react";

/** `waiting` for the frame's page, `arrived` but not running, `begun` but without a picture, `drawn`. */
export type SceneStage = "waiting" | "arrived" | "begun" | "drawn";

const STAGES: readonly SceneStage[] = ["waiting", "arrived", "begun", "drawn"];

/** The stage that a message tells; null if it is about something else. */
export function stageIn(data: unknown): SceneStage | null {
  if (typeof data !== "object" || data === null || !("scene" in data)) return null;
  return STAGES.find((stage) => stage === data.scene) ?? null;
}

/** What is awaited, in words; null once the scene is there. */
export function loadingWords(stage: SceneStage, detail: "full" | "light"): string | null {
  if (stage === "drawn") return null;
  const awaited = {
    waiting: "0.8 MB, once per browser",
    arrived: "starting the viewer",
    begun: "drawing robot and target for the first time",
  }[stage];
  const slow = stage === "begun" && detail === "full" ? " Without a graphics card this takes a while: the light scene is quicker (bottom right)." : "";
  return `Loading the scene: ${awaited}.${slow}`;
}

/** Listens to that frame; `address` says which page it shows, and starts over with another one. */
export function useStage(frame: HTMLIFrameElement | null, address: string): SceneStage {
  const [latest, setLatest] = useState<{ readonly address: string; readonly stage: SceneStage }>({ address, stage: "waiting" });
  useEffect(() => {
    const listen = (event: MessageEvent): void => {
      if (event.source === null || event.source !== frame?.contentWindow || event.origin !== location.origin) return;
      const stage = stageIn(event.data);
      if (stage !== null) setLatest({ address, stage });
    };
    addEventListener("message", listen);
    return () => {
      removeEventListener("message", listen);
    };
  }, [frame, address]);
  return latest.address === address ? latest.stage : "waiting";
}

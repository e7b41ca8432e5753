/** Pictures that the frame of a scene has drawn, as it posts them (server/pages/scene_page.py). */

/** Milliseconds in which a picture comes if it ever does: without a graphics card a large one takes many seconds. */
const PATIENCE = 60_000;

interface Posted {
  readonly name: string;
  /** A PNG without a background; empty if it could not be drawn. */
  readonly content: Uint8Array<ArrayBuffer>;
}

/** The picture in a message; null if it is about something else. */
export function pictureIn(data: unknown): Posted | null {
  if (typeof data !== "object" || data === null) return null;
  const { scene, name, content } = data as Record<string, unknown>;
  return scene === "picture" && typeof name === "string" && content instanceof Uint8Array ? { name, content: content as Uint8Array<ArrayBuffer> } : null;
}

/**
 * The picture of that name, once it has been drawn.
 * @param ask has it drawn
 * @throws Error in words, if it cannot be drawn, is not in time, or is not wanted any more
 */
export function drawnPicture(name: string, ask: () => void, given: AbortSignal): Promise<Blob> {
  return new Promise((done, fail) => {
    const end = (): void => {
      removeEventListener("message", listen);
      given.removeEventListener("abort", giveUp);
      clearTimeout(timer);
    };
    const refuse = (why: string): void => {
      end();
      fail(new Error(why));
    };
    const listen = (event: MessageEvent): void => {
      const picture = event.origin === location.origin ? pictureIn(event.data) : null;
      if (picture?.name !== name) return;
      if (picture.content.length === 0) {
        refuse("This browser cannot draw a picture of that size.");
        return;
      }
      end();
      done(new Blob([picture.content], { type: "image/png" }));
    };
    const giveUp = (): void => {
      refuse("Cancelled.");
    };
    const timer = setTimeout(() => {
      refuse("The scene has drawn nothing: it has to be in view.");
    }, PATIENCE);
    addEventListener("message", listen);
    given.addEventListener("abort", giveUp);
    ask();
  });
}

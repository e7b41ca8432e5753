/** The link as the service knows it, asked for again and again while the page is shown. */
import { useEffect, useState } from "react";
import { Refusal } from "../../api/refusal";
import { readLink } from "../../api/service";
import type { LinkStatus } from "../../api/types";

/** Milliseconds between an answer and the next question. */
const PERIOD = 400;
const LOOK_PERIOD = 100;
/** Milliseconds without an answer after which what is shown counts as old. */
const OLD_AFTER = 900;

export interface LinkView {
  readonly link: LinkStatus | null;
  /** Nothing has been heard from the service for a while. */
  readonly old: boolean;
  readonly refusal: Refusal | null;
}

const NOTHING: LinkView = { link: null, old: false, refusal: null };

export function useLink(shown: boolean): LinkView {
  const [view, setView] = useState<LinkView>(NOTHING);
  useEffect(() => {
    if (!shown) return undefined;
    let ended = false;
    let timer: ReturnType<typeof setTimeout> | undefined;
    let answeredAt = performance.now();
    const ask = async (): Promise<void> => {
      const answer = await readLink().catch((cause: unknown) => {
        if (cause instanceof Refusal) return cause;
        throw cause;
      });
      if (ended) return;
      if (answer instanceof Refusal) {
        setView((before) => ({ ...before, refusal: answer }));
      } else {
        answeredAt = performance.now();
        setView({ link: answer, old: false, refusal: null });
      }
      timer = setTimeout(() => void ask(), PERIOD);
    };
    void ask();
    const looks = setInterval(() => {
      const old = performance.now() - answeredAt > OLD_AFTER;
      setView((before) => (before.old === old ? before : { ...before, old }));
    }, LOOK_PERIOD);
    return () => {
      ended = true;
      clearTimeout(timer);
      clearInterval(looks);
    };
  }, [shown]);
  return view;
}

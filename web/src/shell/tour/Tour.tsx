/** A tour of the console on a real capture: a card beside what it speaks of, and the page as usable as ever. */
import { Button } from "@mantine/core";
import { useEffect, useRef, useState } from "react";
import { useSnapshot } from "../../store/context";
import { go } from "../../store/route";
import { leadsOn, STEPS, type Step } from "./steps";
import styles from "./Tour.module.css";

/** Around what is shown, wherever the page moves it. */
function useRing(step: Step | undefined) {
  const ring = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (step === undefined) return undefined;
    let request = 0;
    const frame = (): void => {
      request = requestAnimationFrame(frame);
      const shown = step.target === null ? null : [...document.querySelectorAll<HTMLElement>(step.target)].find((each) => each.checkVisibility());
      const box = shown?.getBoundingClientRect();
      const element = ring.current;
      if (element === null) return;
      element.hidden = box === undefined;
      if (box !== undefined) {
        element.style.transform = `translate(${box.x - 4}px, ${box.y - 4}px)`;
        element.style.width = `${box.width + 8}px`;
        element.style.height = `${box.height + 8}px`;
      }
    };
    frame();
    return () => {
      cancelAnimationFrame(request);
    };
  }, [step]);
  return ring;
}

export function Tour({ onEnd }: { readonly onEnd: () => void }) {
  const [place, setPlace] = useState(0);
  const step = STEPS[place];
  const phase = useSnapshot((snapshot) => snapshot.phase);
  const ring = useRing(step);
  useEffect(() => {
    if (step !== undefined) go(step.page);
  }, [step]);
  const on = leadsOn(step, phase);
  useEffect(() => {
    if (!on) return undefined;
    // The step's own words are read before the next one takes their place.
    const timer = setTimeout(() => { setPlace((before) => before + 1); }, 800);
    return () => {
      clearTimeout(timer);
    };
  }, [on]);
  if (step === undefined) return null;
  const last = place === STEPS.length - 1;
  return (
    <>
      <div ref={ring} className={styles.ring} aria-hidden="true" hidden />
      <section className={styles.card} role="region" aria-label="Tour">
        <h2>{step.title}</h2>
        <p role="status">{step.words}</p>
        <div className={styles.buttons}>
          <span>{`${place + 1} of ${STEPS.length}`}</span>
          <Button size="compact-sm" variant="subtle" onClick={onEnd}>End the tour</Button>
          <Button size="compact-sm" disabled={place === 0} onClick={() => { setPlace(place - 1); }}>Back</Button>
          <Button size="compact-sm" variant="filled" onClick={() => { if (last) onEnd(); else setPlace(place + 1); }}>{last ? "Done" : "Next"}</Button>
        </div>
      </section>
    </>
  );
}

/** Which keys there are, on one sheet; and the keys that belong to the whole page. */
import { Button } from "@mantine/core";
import { Suspense, useCallback, useEffect, useState } from "react";
import { go } from "../store/route";
import { Overlay } from "../ui/Overlay";
import styles from "./Keys.module.css";
import { helpAddress } from "./help";
import { keyMeaning } from "./keys";
import { Palette } from "./later";
import { openTour } from "./tour/open";

const SHEET: readonly (readonly [string, readonly (readonly [string, string])[]])[] = [
  ["Everywhere", [["Esc", "STOP, wherever the focus is"], ["Ctrl K", "Find a page, command, parameter, word or topic"], ["?", "This sheet"], ["G then M R S A W L", "Mission, Runs, Studies, Atlas, Alarms, Link"]]],
  ["Plots", [["← →", "Move the cursor; with Shift in larger steps"], ["+ −", "Zoom about the cursor"], ["Home", "Follow, or the whole run"], ["Enter", "Of a stored run: show that moment"]]],
  ["Maps and tables", [["← → ↑ ↓", "From cell to cell of a map"], ["Shift click", "Select all runs from the one before"]]],
  ["Parameters", [["↑ ↓", "One unit of the second digit up or down"]]],
  ["Gaps between panels", [["← → ↑ ↓", "Make a panel larger or smaller"], ["Home", "Its usual size"]]],
];

function Sheet({ onClose }: { readonly onClose: () => void }) {
  return (
    <Overlay label="Keyboard shortcuts" onClose={onClose}>
      <div className={styles.sheet}>
        <div className={styles.head}>
          <h2>Keys</h2>
          <Button size="compact-sm" data-autofocus onClick={() => { onClose(); openTour(); }}>Tour of two minutes</Button>
          <a href={helpAddress("console.html")} target="_blank" rel="noopener">Documentation</a>
          <Button size="compact-sm" variant="subtle" onClick={onClose}>Close</Button>
        </div>
        {SHEET.map(([title, keys]) => (
          <section key={title}>
            <h3>{title}</h3>
            <dl>
              {keys.map(([key, words]) => (
                <div key={`${key} ${words}`}>
                  <dt><kbd>{key}</kbd></dt>
                  <dd>{words}</dd>
                </div>
              ))}
            </dl>
          </section>
        ))}
      </div>
    </Overlay>
  );
}

type Open = "palette" | "sheet" | null;

const OPEN = "becalm:open";

export function openOver(what: "palette" | "sheet"): void {
  window.dispatchEvent(new CustomEvent(OPEN, { detail: what }));
}

/** A letter that follows "g" within that time leads to a page, milliseconds. */
const CHORD = 1500;

export function Keys() {
  const [open, setOpen] = useState<Open>(null);
  const close = useCallback(() => { setOpen(null); }, []);
  const help = useCallback(() => { setOpen("sheet"); }, []);
  useEffect(() => {
    let chordUntil = 0;
    const pressed = (event: KeyboardEvent): void => {
      const meaning = keyMeaning(event, performance.now() < chordUntil);
      chordUntil = meaning === "chord" ? performance.now() + CHORD : 0;
      if (meaning === null || meaning === "chord") return;
      event.preventDefault();
      if (meaning === "palette") setOpen((before) => (before === "palette" ? null : "palette"));
      else if (meaning === "sheet") setOpen("sheet");
      else go(meaning.page);
    };
    const asked = (event: Event): void => {
      if (event instanceof CustomEvent) setOpen(event.detail === "palette" ? "palette" : "sheet");
    };
    window.addEventListener("keydown", pressed);
    window.addEventListener(OPEN, asked);
    return () => {
      window.removeEventListener("keydown", pressed);
      window.removeEventListener(OPEN, asked);
    };
  }, []);
  if (open === "palette") return <Suspense fallback={null}><Palette onClose={close} onHelp={help} /></Suspense>;
  return open === "sheet" ? <Sheet onClose={close} /> : null;
}

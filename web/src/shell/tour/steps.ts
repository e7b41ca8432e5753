/** The steps of the tour: what each shows, and what leads on by itself. */
import type { Page } from "../../store/route";

export interface Step {
  readonly title: string;
  readonly words: string;
  /** Of what is shown; none for the page as a whole. */
  readonly target: string | null;
  /** The page that it stands on. */
  readonly page: Page;
  /** Phases that lead on to the next step: the person has done what it asks for. */
  readonly until?: readonly string[];
}

export const STEPS: readonly Step[] = [
  { title: "STOP", words: "It stands here on every page, at every size, and Esc does the same wherever you are. Anyone who may see the mission may press it. Nothing in this tour hides it.", target: "#stop-button", page: "mission" },
  { title: "How far to trust what you see", words: "Live, or how old the data are; how many alarms there are; which configuration and engine fly. When data grow old the page turns grey, and only STOP can be pressed.", target: '[aria-label="Data status"]', page: "mission" },
  { title: "What is happening now", words: "Mission time, the phases so far, and in words what the robot does. At the right: spin, drift, contact, cage, and whether the next phase may begin. Words with a dotted line explain themselves.", target: 'section[aria-label="Mission"]', page: "mission" },
  { title: "Capture", words: "Press Capture: the whole sequence begins, here in simulation. The line below says what a hundred futures make of it. The tour goes on as soon as the hands move.", target: 'button[aria-label="Capture"]', page: "mission", until: ["detumbling", "caging"] },
  { title: "The scene", words: "Base, arms and hands; the target with its faces; the path that is planned, forces as arrows. All, Top, Follow and Hand are points of view; Legend names what is drawn.", target: 'section[aria-label="Scene"]', page: "mission" },
  { title: "Plots", words: "One clock and one cursor for all. Drag to zoom, wheel about the cursor, double click for the whole; with the keyboard arrows, + and −. Each plot leaves as SVG, PNG, PDF or CSV.", target: 'figure[aria-label^="Tip force"]', page: "mission" },
  { title: "How it ends", words: "Every touch with its peak, then the verdict: whether no motion leads the target out of the hands, by which margin, how softly. Problems and events stand below.", target: '[data-panel="outcome"] > section', page: "mission" },
  { title: "Change something", words: "Edits are staged, can be rehearsed in a hundred futures as they are and as changed, and are applied together. Undo takes an Apply back. What is typed outlives a reload.", target: 'input[aria-label="Search parameters"]', page: "mission" },
  { title: "Nothing is lost", words: "Every mission is a run: replayed in its own scene, compared, forked at any moment, downloaded. Select several to plot them together or to read their statistics.", target: '[aria-label="Table of runs"], [aria-label="Runs"]', page: "runs" },
  { title: "Find anything", words: "Ctrl+K finds pages, commands, parameters, words and help by name; ? shows the keys. The question mark at the top opens the documentation at the page you are on. That is all: enjoy the calm.", target: 'button[aria-label="Search everything"]', page: "runs" },
];

/** Whether the mission has done what a step asks for. */
export const leadsOn = (step: Step | undefined, phase: string | null): boolean => phase !== null && step?.until?.includes(phase) === true;

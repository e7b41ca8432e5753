/** Phases by the numbers they have in the log, with the words and the order on the screen. */

export const PHASES = ["idle", "detumbling", "caging", "holding", "released", "stopped", "faulted"] as const;
export type Phase = (typeof PHASES)[number];

export const PHASE_WORDS: Readonly<Record<Phase, string>> = {
  idle: "Idle",
  detumbling: "Detumbling",
  caging: "Caging",
  holding: "Holding",
  released: "Released",
  stopped: "Stopped",
  faulted: "Faulted",
};

export const isPhase = (word: string): word is Phase => (PHASES as readonly string[]).includes(word);

export const phaseCode = (word: string): number => (PHASES as readonly string[]).indexOf(word);

/** The phase of that number; a number unknown to this console is shown as idle rather than as a failure. */
export const phaseOf = (code: number): Phase => PHASES[code] ?? "idle";

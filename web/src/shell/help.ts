/** Where the documentation that comes with the service says more (web/documentation.ts builds it). */
import { addressOf } from "../api/address";
import type { Page } from "../store/route";

export interface Topic {
  /** Page and heading, as in docs/. */
  readonly topic: string;
  readonly words: string;
}

export const HELP: readonly Topic[] = [
  { topic: "console.html#mission", words: "The mission page" },
  { topic: "console.html#runs", words: "Runs: table, replay, plots, comparison" },
  { topic: "console.html#studies", words: "Studies and their maps" },
  { topic: "console.html#atlas", words: "The atlas" },
  { topic: "console.html#alarms", words: "Alarms, limits and the shift log" },
  { topic: "console.html#link", words: "The link page" },
  { topic: "console.html#keys", words: "Keys, and finding things" },
  { topic: "rehearsal.html", words: "Rehearsals: odds, bands, uncertainty" },
  { topic: "studies.html", words: "Studies: grids, draws, results" },
  { topic: "logs.html", words: "Logs and their columns" },
  { topic: "method.html", words: "The method and its equations" },
  { topic: "conventions.html", words: "Frames, units, names" },
  { topic: "operations.html", words: "Operations: settings, data, measures" },
  { topic: "link.html", words: "The robot link" },
  { topic: "access.html", words: "Access: tokens, roles, control" },
  { topic: "api.html", words: "The API" },
];

export const helpAddress = (topic: string): string => addressOf(`/help/${topic}`);

/** What a page's own help opens. */
export const PAGE_HELP: Readonly<Record<Page, string>> = {
  mission: "console.html#mission",
  runs: "console.html#runs",
  studies: "console.html#studies",
  atlas: "console.html#atlas",
  alarms: "console.html#alarms",
  link: "console.html#link",
};

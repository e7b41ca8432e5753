import type { Page } from "../store/route";

export const PAGE_LABELS: Readonly<Record<Page, string>> = { mission: "Mission", runs: "Runs", studies: "Studies", atlas: "Atlas", alarms: "Alarms", link: "Link" };

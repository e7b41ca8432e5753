import { readdirSync } from "node:fs";
import { join } from "node:path";
import { ESLint, Linter } from "eslint";
import { describe, expect, it } from "vitest";

const WEB = join(import.meta.dirname, "..");
const eslint = new ESLint({ cwd: WEB });

/** What the configuration of the page's own lint says of one import in a file. */
async function findings(file: string, imported: string): Promise<string[]> {
  const config = (await eslint.calculateConfigForFile(join(WEB, "src", file))) as Linter.Config;
  const rule = config.rules?.["no-restricted-imports"];
  if (rule === undefined) throw new Error(`no rule about imports holds for ${file}`);
  return new Linter().verify(`import "${imported}";`, { rules: { "no-restricted-imports": rule } }).map(({ message }) => message);
}

describe("the order of the folders", () => {
  it.each([
    ["ui/Panel.tsx", "../features/access/session", "ui does not know"],
    ["ui/export/figure-file.ts", "../../units/units", "ui does not know"],
    ["units/units.ts", "../api/service", "units does not know"],
    ["api/service.ts", "../source/live", "api does not know"],
    ["source/live.ts", "../store/mission", "source does not know"],
    ["source/live.ts", "../client/schema", "source does not know"],
    ["store/mission.ts", "../features/plots/chart", "store does not know"],
    ["features/plots/chart.ts", "../../shell/Shell", "features/plots does not know"],
    ["features/access/session.ts", "../commands/desk", "features/access imports"],
    ["features/plots/chart.ts", "../../features/library/query", "features/plots imports"],
    ["stop/send.ts", "../api/address", "stop does not know"],
    ["stop/main.ts", "../ui/Panel", "stop does not know"],
  ])("forbids %s to import %s", async (file, imported, message) => {
    expect(await findings(file, imported)).toEqual([expect.stringContaining(message)]);
  });

  it.each([
    ["ui/export/ExportMenu.tsx", "../EscNote"],
    ["units/preferences.ts", "../ui/use-kept"],
    ["api/service.ts", "../client/schema"],
    ["source/live.ts", "../api/service"],
    ["store/mission.ts", "../source/series"],
    ["features/library/RunView.tsx", "../plots/PlotPanel"],
    ["features/link/latency-chart.ts", "../plots/chart"],
    ["shell/Shell.tsx", "../features/link/LinkPage"],
    ["stop/send.ts", "./patience"],
  ])("lets %s import %s", async (file, imported) => {
    expect(await findings(file, imported)).toEqual([]);
  });

  it("has a place for every folder", async () => {
    const folders = (under: string): string[] => readdirSync(join(WEB, "src", under), { withFileTypes: true }).filter((entry) => entry.isDirectory()).map(({ name }) => name);
    const rooms = [...folders("").filter((name) => name !== "client" && name !== "features"), ...folders("features").map((name) => `features/${name}`)];
    for (const room of rooms) expect(await findings(`${room}/any.ts`, "react")).toEqual([]);
  });
});

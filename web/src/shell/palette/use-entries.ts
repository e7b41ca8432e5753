/** Everything that the palette can find, as the page is now. */
import { useMantineColorScheme } from "@mantine/core";
import { useMemo } from "react";
import { CAPTURE, RESET, SEQUENCE } from "../../features/commands/catalogue";
import { findParameter } from "../../features/parameters/find";
import { glossaryTerms } from "../../features/glossary/glossary";
import { useConfiguration } from "../../store/configuration";
import { go, PAGES } from "../../store/route";
import { CONTRAST } from "../../ui/theme/contrast";
import { useShared } from "../../ui/use-shared";
import { usePreferences } from "../../units/preferences";
import { HELP, helpAddress } from "../help";
import { useLayout, VIEW_WORDS, VIEWS } from "../layout";
import { PAGE_LABELS } from "../pages";
import { openTour } from "../tour/open";
import type { Entry } from "./entries";

/** Shown before anything was typed. */
export const UNASKED: ReadonlySet<string> = new Set(["Pages", "Commands", "View", "This browser", "Help"]);

/** A command is given by its own button, which says what it does and why it may not be pressed: the palette leads to it. */
function focusCommand(label: string): void {
  go("mission");
  // The page is shown with the next frame but one.
  setTimeout(() => {
    const buttons = [...document.querySelectorAll<HTMLButtonElement>("section button")];
    const button = buttons.find((each) => each.getAttribute("aria-label") === label);
    button?.scrollIntoView({ block: "nearest" });
    button?.focus();
  }, 60);
}

function searchRuns(): void {
  go("runs");
  setTimeout(() => document.querySelector<HTMLInputElement>('input[aria-label="Search runs"]')?.focus(), 60);
}

const entry = (group: string, label: string, hint: string, run: () => void, words = ""): Entry => ({ id: `${group} ${label} ${hint}`, group, label, hint, words, run });

const pages = (): Entry[] => PAGES.map((page) => entry("Pages", PAGE_LABELS[page], "", () => { go(page); }, "go to page"));

const commands = (): Entry[] => [CAPTURE, ...SEQUENCE, RESET].map(({ label, does }) => entry("Commands", label, does, () => { focusCommand(label); }, "command button"));

const help = (): Entry[] => HELP.map(({ topic, words }) => entry("Help", words, "", () => { window.open(helpAddress(topic), "_blank", "noopener"); }, "documentation"));

export function useEntries(onHelp: () => void): readonly Entry[] {
  const { parameters } = useConfiguration();
  const { angles, setAngles } = usePreferences();
  const { colorScheme, setColorScheme } = useMantineColorScheme();
  const [contrast, setContrast] = useShared(CONTRAST);
  const [layout, setLayout] = useLayout();
  return useMemo(() => {
    const other = colorScheme === "light" ? "dark" : "light";
    const views = VIEWS.map((view) => entry("View", VIEW_WORDS[view], layout.view === view ? "now" : "", () => { go("mission"); setLayout({ ...layout, view }); }, "layout maximise panel"));
    const choices = [
      entry("This browser", `Switch to the ${other} theme`, "", () => { setColorScheme(other); }, "colours"),
      entry("This browser", angles === "rad" ? "Angles in degrees" : "Angles in radians", "", () => { setAngles(angles === "rad" ? "deg" : "rad"); }, "unit"),
      entry("This browser", contrast === "high" ? "Usual contrast" : "High contrast", "", () => { setContrast(contrast === "high" ? "usual" : "high"); }, "accessibility"),
    ];
    const helping = [entry("Help", "Keyboard shortcuts", "?", onHelp), entry("Help", "Tour of two minutes", "", openTour, "first steps introduction")];
    const found = parameters.map(({ path, title, description }) => entry("Parameters", title, path, () => { go("mission"); findParameter(path); }, description));
    const words = glossaryTerms().map(({ term, meaning }) => entry("Words", term, meaning, () => undefined));
    const runs = [entry("Runs", "Search the runs", "by name, tag, note or parameter", searchRuns)];
    return [...pages(), ...commands(), ...views, ...choices, ...helping, ...help(), ...runs, ...found, ...words];
  }, [parameters, angles, setAngles, colorScheme, setColorScheme, contrast, setContrast, layout, setLayout, onHelp]);
}

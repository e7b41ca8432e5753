import { ActionIcon, Button, SegmentedControl, Tooltip, useMantineColorScheme } from "@mantine/core";
import { useState } from "react";
import { addressOf } from "../api/address";
import { Identity } from "../features/access/Identity";
import { ControlState } from "../features/control/ControlState";
import { Icon } from "../ui/theme/Icon";
import { usePreferences } from "../units/preferences";
import { hashOf, PAGES, type Page } from "../store/route";
import { helpAddress, PAGE_HELP } from "./help";
import { openOver } from "./Keys";
import { PAGE_LABELS } from "./pages";
import styles from "./TopBar.module.css";
import { ViewMenu } from "./ViewMenu";

function ThemeSwitch() {
  const { colorScheme, setColorScheme } = useMantineColorScheme();
  const other = colorScheme === "light" ? "dark" : "light";
  return (
    <Tooltip label={`Switch to the ${other} theme`} position="bottom">
      <ActionIcon
        variant="subtle"
        color="gray"
        aria-label={`Switch to the ${other} theme`}
        onClick={() => {
          setColorScheme(other);
        }}
      >
        <Icon icon={other === "light" ? "sun" : "moon"} />
      </ActionIcon>
    </Tooltip>
  );
}

/** Finding things, and the documentation at the place that tells of this page. */
function Finding({ page }: { readonly page: Page }) {
  return (
    <>
      <Tooltip label="Find a page, command, parameter, word or topic (Ctrl+K)" position="bottom">
        <ActionIcon variant="subtle" color="gray" aria-label="Search everything" onClick={() => { openOver("palette"); }}>
          <Icon icon="search" />
        </ActionIcon>
      </Tooltip>
      <Tooltip label="What the documentation says of this page; ? shows the keys" position="bottom">
        <ActionIcon component="a" variant="subtle" color="gray" aria-label={`Help: ${PAGE_LABELS[page]}`} href={helpAddress(PAGE_HELP[page])} target="_blank" rel="noopener">
          <Icon icon="help" />
        </ActionIcon>
      </Tooltip>
    </>
  );
}

function AngleSwitch() {
  const { angles, setAngles } = usePreferences();
  return (
    <SegmentedControl
      aria-label="Angle unit"
      value={angles}
      onChange={(value) => {
        setAngles(value);
      }}
      data={[
        { value: "rad", label: "rad" },
        { value: "deg", label: "deg" },
      ]}
    />
  );
}

function Pages({ shown, onChosen }: { readonly shown: Page; readonly onChosen: () => void }) {
  return (
    <nav className={styles.pages} aria-label="Pages">
      {PAGES.map((page) => (
        <a key={page} href={hashOf({ page, item: "" })} aria-current={page === shown ? "page" : undefined} onClick={onChosen}>
          {PAGE_LABELS[page]}
        </a>
      ))}
    </nav>
  );
}

/** Where the bar is narrow, everything but its name and STOP's place goes behind this button. */
function MenuButton({ open, onChange }: { readonly open: boolean; readonly onChange: (open: boolean) => void }) {
  return (
    <Button
      className={styles.menu ?? ""}
      aria-expanded={open}
      aria-controls={MENU}
      onClick={() => {
        onChange(!open);
      }}
    >
      Menu
    </Button>
  );
}

const MENU = "top-bar-menu";

export function TopBar({ page }: { readonly page: Page }) {
  const [open, setOpen] = useState(false);
  const close = (): void => {
    setOpen(false);
  };
  return (
    <header className={styles.bar} data-open={open || undefined}>
      <div className={styles.brand}>
        <img src={addressOf("/favicon.svg")} alt="" width={24} height={24} />
        <h1 className={styles.name}>Becalm</h1>
      </div>
      <MenuButton open={open} onChange={setOpen} />
      <Pages shown={page} onChosen={close} />
      <div className={styles.tools} id={MENU}>
        {page === "mission" && <ViewMenu />}
        <ControlState />
        <Identity />
        <Finding page={page} />
        <AngleSwitch />
        <ThemeSwitch />
      </div>
    </header>
  );
}

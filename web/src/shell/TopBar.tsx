import { ActionIcon, Button, SegmentedControl, Tooltip, useMantineColorScheme } from "@mantine/core";
import { useState } from "react";
import { addressOf } from "../api/address";
import { Identity } from "../features/access/Identity";
import { ControlState } from "../features/control/ControlState";
import { Icon } from "../ui/theme/Icon";
import { usePreferences } from "../units/preferences";
import { hashOf, PAGES, type Page } from "../store/route";
import styles from "./TopBar.module.css";

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

const PAGE_LABELS: Readonly<Record<Page, string>> = { mission: "Mission", runs: "Runs", studies: "Studies", link: "Link" };

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
        <ControlState />
        <Identity />
        <AngleSwitch />
        <ThemeSwitch />
      </div>
    </header>
  );
}

/** How the mission page is laid out. */
import { Button, SegmentedControl } from "@mantine/core";
import { useState } from "react";
import { CopyButton } from "../ui/CopyButton";
import { Popup } from "../ui/Popup";
import { addressOf, DEFAULT_LAYOUT, useLayout, VIEW_WORDS, VIEWS } from "./layout";
import styles from "./TopBar.module.css";

export function ViewMenu() {
  const [layout, setLayout] = useLayout();
  const [opened, setOpened] = useState(false);
  return (
    <Popup opened={opened} onChange={setOpened} target={<Button aria-expanded={opened} title="What the mission page shows, and how wide its panels are" onClick={() => { setOpened(!opened); }}>{`View: ${VIEW_WORDS[layout.view]}`}</Button>}>
      <div className={styles.view}>
        <SegmentedControl aria-label="What the mission page shows" value={layout.view} data={VIEWS.map((value) => ({ value, label: VIEW_WORDS[value] }))} onChange={(view) => { setLayout({ ...layout, view }); }} />
        <p>Drag the gaps between the panels, and the dots at their titles, or move either with the arrow keys. This browser keeps it.</p>
        <div className={styles.row}>
          <Button size="compact-sm" onClick={() => { setLayout({ ...DEFAULT_LAYOUT, view: layout.view }); }}>Usual layout</Button>
          <CopyButton label="Copy link" title="Copy an address that opens the page laid out like this" text={() => new URL(addressOf(layout), location.href).href} />
        </div>
      </div>
    </Popup>
  );
}

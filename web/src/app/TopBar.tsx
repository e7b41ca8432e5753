import { ActionIcon, SegmentedControl, Tooltip, useMantineColorScheme } from "@mantine/core";
import { addressOf } from "../api/address";
import { Identity } from "../features/access/Identity";
import { ControlState } from "../features/control/ControlState";
import { isPhase, PHASE_WORDS } from "../store/phases";
import { useSnapshot } from "../store/context";
import { Icon } from "../theme/Icon";
import { LinkState } from "./LinkState";
import { usePreferences } from "./preferences";
import { hashOf, PAGES, type Page } from "./route";
import styles from "./TopBar.module.css";

function ThemeSwitch() {
  const { colorScheme, setColorScheme } = useMantineColorScheme();
  const other = colorScheme === "light" ? "dark" : "light";
  return (
    <Tooltip label={`Change to the ${other} theme`}>
      <ActionIcon
        variant="subtle"
        color="gray"
        aria-label={`Change to the ${other} theme`}
        onClick={() => {
          setColorScheme(other);
        }}
      >
        <Icon sign={other === "light" ? "sun" : "moon"} />
      </ActionIcon>
    </Tooltip>
  );
}

function AngleSwitch() {
  const { angles, setAngles } = usePreferences();
  return (
    <SegmentedControl
      aria-label="Unit of angles"
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

const PAGE_WORDS: Readonly<Record<Page, string>> = { mission: "Mission", runs: "Runs", studies: "Studies", link: "Link" };

function Pages({ shown }: { readonly shown: Page }) {
  return (
    <nav className={styles.pages} aria-label="Pages">
      {PAGES.map((page) => (
        <a key={page} href={hashOf({ page, item: "" })} aria-current={page === shown ? "page" : undefined}>
          {PAGE_WORDS[page]}
        </a>
      ))}
    </nav>
  );
}

/** On its own page the mission's strip tells the phase; elsewhere it stands here. */
function MissionFacts({ phased }: { readonly phased: boolean }) {
  const configuration = useSnapshot((snapshot) => snapshot.configuration);
  const run = useSnapshot((snapshot) => snapshot.run_id);
  const phase = useSnapshot((snapshot) => snapshot.phase);
  return (
    <dl className={styles.mission}>
      {phased && (
        <div>
          <dt>Phase</dt>
          <dd>{phase !== null && isPhase(phase) ? PHASE_WORDS[phase] : "—"}</dd>
        </div>
      )}
      <div>
        <dt>Configuration</dt>
        <dd>{configuration ?? "—"}</dd>
      </div>
      <div>
        <dt>Run</dt>
        <dd className={styles.run}>{run ?? "—"}</dd>
      </div>
    </dl>
  );
}

export function TopBar({ page }: { readonly page: Page }) {
  return (
    <header className={styles.bar}>
      <div className={styles.brand}>
        <img src={addressOf("/favicon.svg")} alt="" width={24} height={24} />
        <h1 className={styles.name}>Becalm</h1>
      </div>
      <Pages shown={page} />
      <MissionFacts phased={page !== "mission"} />
      <div className={styles.tools}>
        <ControlState />
        <Identity />
        <LinkState />
        <AngleSwitch />
        <ThemeSwitch />
      </div>
    </header>
  );
}

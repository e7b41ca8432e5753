import { ActionIcon, SegmentedControl, Tooltip, useMantineColorScheme } from "@mantine/core";
import { StopButton } from "../features/commands/StopButton";
import { useSnapshot } from "../store/context";
import { Icon } from "../theme/Icon";

import { LinkState } from "./LinkState";
import { usePreferences } from "./preferences";
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

export function TopBar() {
  const configuration = useSnapshot((snapshot) => snapshot.configuration);
  const run = useSnapshot((snapshot) => snapshot.run_id);
  return (
    <header className={styles.bar}>
      <div className={styles.brand}>
        <img src="/favicon.svg" alt="" width={24} height={24} />
        <h1 className={styles.name}>Becalm</h1>
      </div>
      <dl className={styles.mission}>
        <div>
          <dt>Configuration</dt>
          <dd>{configuration ?? "—"}</dd>
        </div>
        <div>
          <dt>Run</dt>
          <dd className={styles.run}>{run ?? "—"}</dd>
        </div>
      </dl>
      <div className={styles.tools}>
        <LinkState />
        <AngleSwitch />
        <ThemeSwitch />
        <StopButton />
      </div>
    </header>
  );
}

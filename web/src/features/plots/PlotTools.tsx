/** Which stretch of time the plots show. */
import { Button, SegmentedControl } from "@mantine/core";
import { Icon } from "../../ui/theme/Icon";
import styles from "./PlotPanel.module.css";
import type { TimeView, Window } from "./timeview";

interface PlotToolsProps {
  readonly view: TimeView;
  readonly change: (view: TimeView) => void;
  /** Mission time of the newest sample. */
  readonly now: () => number;
  /** Whether what is shown goes on by itself. */
  readonly following: boolean;
}

const WINDOWS = [
  { value: "10", label: "10 s" },
  { value: "30", label: "30 s" },
  { value: "0", label: "All" },
];

export function PlotTools({ view, change, now, following }: PlotToolsProps) {
  const still = view.pausedAt !== null;
  return (
    <div className={styles.tools}>
      {view.zoomed && (
        <Button
          size="compact-xs"
          leftSection={<Icon icon="follow" size={12} />}
          onClick={() => {
            change({ ...view, zoomed: null });
          }}
        >
          {following ? "Follow" : "Whole run"}
        </Button>
      )}
      {following && (
        <Button
          size="compact-xs"
          aria-pressed={still}
          leftSection={<Icon icon={still ? "play" : "pause"} size={12} />}
          onClick={() => {
            change({ ...view, pausedAt: still ? null : now() });
          }}
        >
          {still ? "Resume plots" : "Pause plots"}
        </Button>
      )}
      <SegmentedControl
        aria-label="Time window"
        value={String(view.window)}
        data={WINDOWS}
        onChange={(value) => {
          change({ ...view, zoomed: null, window: Number(value) as Window });
        }}
      />
    </div>
  );
}

/** The 3D view, served by the same service; keys pressed in it reach STOP too. */
import { ActionIcon, Tooltip } from "@mantine/core";
import { useState } from "react";
import { useKept } from "../../app/preferences";
import { useView } from "../../store/context";
import { Icon } from "../../theme/Icon";
import { useStopKey } from "../commands/stop-key";
import styles from "./ScenePanel.module.css";

/** `light` draws a quarter of the pixels. */
type Detail = "full" | "light";

const ADDRESSES: Readonly<Record<Detail, string>> = { full: "/scene/", light: "/scene/?fixedDpr=0.5" };

interface DetailSwitchProps {
  readonly detail: Detail;
  readonly choose: (detail: Detail) => void;
}

function DetailSwitch({ detail, choose }: DetailSwitchProps) {
  const label = detail === "full" ? "Draw the scene lightly, for a computer without a graphics card" : "Draw the scene in full detail";
  return (
    <Tooltip label={label} position="left">
      <ActionIcon
        className={styles.detail ?? ""}
        aria-label="Light scene"
        aria-pressed={detail === "light"}
        onClick={() => {
          choose(detail === "full" ? "light" : "full");
        }}
      >
        <Icon sign="detail" />
      </ActionIcon>
    </Tooltip>
  );
}

interface LoadedFrame {
  readonly window: Window | null;
}

export function ScenePanel() {
  // A new object with every load: a frame that navigates keeps its window but forgets its listeners.
  const [loaded, setLoaded] = useState<LoadedFrame | null>(null);
  const begun = useView((view) => view.snapshot !== null);
  const old = useView((view) => view.trust === "stale" || view.trust === "preparing");
  // The view does not find its way back to a service that was away; with each new connection it is loaded anew.
  const connection = useView((view) => view.connections);
  const preparing = useView((view) => view.trust === "preparing");
  const [detail, setDetail] = useKept<Detail>("becalm-scene", "full", ["full", "light"]);
  useStopKey(loaded);

  return (
    <section className={styles.scene} aria-label="Scene">
      {begun && (
        <iframe
          key={connection}
          src={ADDRESSES[detail]}
          title="3D view of robot and target"
          className={styles.frame}
          onLoad={(event) => {
            setLoaded({ window: event.currentTarget.contentWindow });
          }}
        />
      )}
      {!begun && (
        <p className={styles.empty}>
          {preparing ? "The scene appears when the controller is ready." : "The scene appears when the service answers."}
        </p>
      )}
      {begun && <DetailSwitch detail={detail} choose={setDetail} />}
      {begun && old && <div className={styles.veil} aria-hidden="true" />}
    </section>
  );
}

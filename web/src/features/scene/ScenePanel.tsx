/** The 3D view, served by the same service; keys pressed in it reach STOP too (src/stop/key.ts). */
import { ActionIcon, Tooltip } from "@mantine/core";
import { useEffect, useState } from "react";
import { changeScene, readScene } from "../../api/service";
import type { SceneView } from "../../api/types";
import { useView } from "../../store/context";
import { Icon } from "../../theme/Icon";
import { useReasonByRole } from "../access/session";
import { sceneAddress, useDetail, type Detail } from "./detail";
import { SceneChoices } from "./SceneChoices";
import styles from "./ScenePanel.module.css";

/** How the live scene stands, read with each connection; it is the same for all browsers. */
function useLiveArrangement(connection: number): SceneView | null {
  const [arrangement, setArrangement] = useState<SceneView | null>(null);
  useEffect(() => {
    // Without an answer there are no choices to show; the next connection asks again.
    if (connection > 0) readScene().then(setArrangement, () => undefined);
  }, [connection]);
  return arrangement;
}

function LiveChoices({ connection }: { readonly connection: number }) {
  const arrangement = useLiveArrangement(connection);
  const against = useReasonByRole("operator");
  if (arrangement === null) return null;
  // What the service refuses is shown by the scene staying as it is.
  return <SceneChoices view={arrangement} against={against} onChange={(change) => void changeScene(change).catch(() => undefined)} />;
}

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

export function ScenePanel() {
  const begun = useView((view) => view.snapshot !== null);
  const old = useView((view) => view.trust === "stale" || view.trust === "preparing" || view.robotAge > 0);
  // The view does not find its way back to a service that was away; with each new connection it is loaded anew.
  const connection = useView((view) => view.connections);
  const preparing = useView((view) => view.trust === "preparing");
  const { detail, choose } = useDetail();

  return (
    <section className={styles.scene} aria-label="Scene">
      {begun && (
        <iframe
          key={connection}
          src={sceneAddress("/scene/", detail)}
          title="3D view of robot and target"
          className={styles.frame}
        />
      )}
      {!begun && (
        <p className={styles.empty}>
          {preparing ? "The scene appears when the controller is ready." : "The scene appears when the service answers."}
        </p>
      )}
      {begun && <LiveChoices key={connection} connection={connection} />}
      {begun && <DetailSwitch detail={detail} choose={choose} />}
      {begun && old && <div className={styles.veil} aria-hidden="true" />}
    </section>
  );
}

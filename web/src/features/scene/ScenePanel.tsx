/** The 3D view, served by the same service; keys pressed in it reach STOP too (src/stop/key.ts). */
import { ActionIcon, Tooltip } from "@mantine/core";
import { useEffect, useState } from "react";
import { changeScene, readScene } from "../../api/service";
import type { SceneView } from "../../api/types";
import { useView } from "../../store/context";
import { Icon } from "../../ui/theme/Icon";
import { usePageVisible } from "../../ui/use-page-visible";
import { useReasonByRole } from "../access/session";
import { sceneAddress, useDetail, type DetailChoice } from "./detail";
import { SceneChoices } from "./SceneChoices";
import { SceneFrame } from "./SceneFrame";
import styles from "./ScenePanel.module.css";

/** Milliseconds between two looks at what others have chosen. */
const LOOK_PERIOD = 3000;

const same = (one: SceneView | null, other: SceneView): boolean => JSON.stringify(one) === JSON.stringify(other);

/** How the live scene stands; it is the same for all browsers, whoever of them chose it. */
function useLiveArrangement(connection: number): SceneView | null {
  const [arrangement, setArrangement] = useState<SceneView | null>(null);
  const visible = usePageVisible();
  useEffect(() => {
    if (connection === 0 || !visible) return undefined;
    const look = (): void => {
      // Without an answer the choices stay as they are; the next look asks again.
      readScene().then((found) => { setArrangement((before) => (same(before, found) ? before : found)); }, () => undefined);
    };
    look();
    const timer = setInterval(look, LOOK_PERIOD);
    return () => {
      clearInterval(timer);
    };
  }, [connection, visible]);
  return arrangement;
}

function LiveChoices({ connection }: { readonly connection: number }) {
  const arrangement = useLiveArrangement(connection);
  const against = useReasonByRole("operator");
  if (arrangement === null) return null;
  // What the service refuses is shown by the scene staying as it is.
  return <SceneChoices view={arrangement} against={against} onChange={(change) => void changeScene(change).catch(() => undefined)} />;
}

function DetailSwitch({ detail, choose, byItself }: DetailChoice) {
  const label =
    detail === "full"
      ? "Draw the scene lightly: fewer pixels, no shadows, for a computer without a graphics card"
      : `Draw the scene in full detail${byItself ? "; it is light because this browser draws in software" : ""}`;
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
  const connection = useView((view) => view.connections);
  const preparing = useView((view) => view.trust === "preparing");
  const detail = useDetail();

  return (
    <section className={styles.scene} aria-label="Scene">
      {begun && (
        <SceneFrame
          address={sceneAddress("/scene/", detail.detail)}
          detail={detail.detail}
          title="3D view of robot and target"
        />
      )}
      {!begun && (
        <p className={styles.empty}>
          {preparing ? "The scene appears when the controller is ready." : "The scene appears when the service answers."}
        </p>
      )}
      {begun && <LiveChoices key={connection} connection={connection} />}
      {begun && <DetailSwitch {...detail} />}
      {begun && old && <div className={styles.veil} aria-hidden="true" />}
    </section>
  );
}

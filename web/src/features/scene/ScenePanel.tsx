/** The 3D view, served by the same service; keys pressed in it reach STOP too (src/stop/key.ts). */
import { ActionIcon, Tooltip } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import type { SceneChange } from "../../api/types";
import { useStore, useView } from "../../store/context";
import { Icon } from "../../ui/theme/Icon";
import { useReasonByRole } from "../access/session";
import { sceneAddress, useDetail, type DetailChoice } from "./detail";
import { SceneChoices } from "./SceneChoices";
import { SceneFrame } from "./SceneFrame";
import styles from "./ScenePanel.module.css";

/** Milliseconds between two looks at what others have chosen. */
const CHECK_PERIOD = 3000;

/** The camera and the layers of that page; the live scene has the same for all browsers, whoever of them chose. */
function Arrangement({ page }: { readonly page: string }) {
  const { scene } = useStore().source;
  const connections = useView((view) => view.connections);
  const queryKey = ["scene", page, connections];
  const { data } = useQuery({ queryKey, queryFn: () => scene.read(), refetchInterval: CHECK_PERIOD });
  const client = useQueryClient();
  const byRole = useReasonByRole(scene.changeNeeds ?? "viewer");
  const disabledReason = scene.changeNeeds === null ? null : byRole;
  if (data === undefined) return null;
  const change = async (next: SceneChange): Promise<void> => {
    // What the service refuses is shown by the scene staying as it is.
    await scene.change(next).catch(() => undefined);
    await client.invalidateQueries({ queryKey });
  };
  return <SceneChoices view={data} disabledReason={disabledReason} onChange={(next) => void change(next)} />;
}

function DetailSwitch({ detail, choose, byItself }: DetailChoice) {
  const label =
    detail === "full"
      ? "Draw a light scene: fewer pixels, no shadows, for computers without a graphics card"
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
        <Icon icon="detail" />
      </ActionIcon>
    </Tooltip>
  );
}

/** Why there is no scene (yet). */
function Empty() {
  const ended = useView((view) => view.ended);
  const preparing = useView((view) => view.trust === "preparing");
  const words = ended ?? (preparing ? "The scene appears when the controller is ready." : "The scene appears when the service answers.");
  return (
    <p className={styles.empty} role={ended === null ? undefined : "alert"}>
      {words}
    </p>
  );
}

export function ScenePanel({ onDrawn }: { readonly onDrawn?: (drawn: boolean) => void }) {
  const page = useView((view) => (view.ended === null ? view.scene : null));
  const old = useView((view) => view.trust === "stale" || view.trust === "preparing" || view.robotAge > 0);
  const detail = useDetail();
  return (
    <section className={styles.scene} aria-label="Scene">
      {page === null ? (
        <Empty />
      ) : (
        <>
          <SceneFrame address={sceneAddress(page, detail.detail)} detail={detail.detail} title="3D view of robot and target" onDrawn={onDrawn} />
          <Arrangement key={page} page={page} />
          <DetailSwitch {...detail} />
          {old && <div className={styles.veil} aria-hidden="true" />}
        </>
      )}
    </section>
  );
}

/** The 3D view, served by the same service; keys pressed in it reach STOP too. */
import { useState } from "react";
import { useView } from "../../store/context";
import { useStopKey } from "../commands/stop-key";
import styles from "./ScenePanel.module.css";

interface LoadedFrame {
  readonly window: Window | null;
}

export function ScenePanel() {
  // A new object with every load: a frame that navigates keeps its window but forgets its listeners.
  const [loaded, setLoaded] = useState<LoadedFrame | null>(null);
  const begun = useView((view) => view.snapshot !== null);
  const stale = useView((view) => view.trust === "stale");
  const preparing = useView((view) => view.trust === "preparing");
  useStopKey(loaded);

  return (
    <section className={styles.scene} aria-label="Scene">
      {begun && (
        <iframe
          src="/scene/"
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
      {stale && <div className={styles.veil} aria-hidden="true" />}
    </section>
  );
}

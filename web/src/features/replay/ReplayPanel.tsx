/** A mission at any of its moments: scene and readings, and the controls that choose the moment. */
import { useState } from "react";
import { useStore } from "../../store/context";
import { Readings } from "../mission/Readings";
import { ScenePanel } from "../scene/ScenePanel";
import styles from "./ReplayPanel.module.css";
import { Transport } from "./Transport";

export function ReplayPanel() {
  const { playback, takePicture } = useStore().source;
  const [drawn, setDrawn] = useState(false);
  return (
    <section className={styles.replay} aria-label="Replay in the scene">
      <ScenePanel onDrawn={setDrawn} />
      {playback !== null && <Transport playback={playback} takePicture={takePicture} drawn={drawn} />}
      <Readings label="At this moment" />
    </section>
  );
}

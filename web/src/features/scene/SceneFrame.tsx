/** A scene in its frame, live or recorded, and what is awaited until it can be seen. */
import { useState } from "react";
import type { Detail } from "./detail";
import { loadingWords, useStage } from "./loading";
import styles from "./ScenePanel.module.css";

interface SceneFrameProps {
  readonly address: string;
  readonly detail: Detail;
  readonly title: string;
}

export function SceneFrame({ address, detail, title }: SceneFrameProps) {
  const [frame, setFrame] = useState<HTMLIFrameElement | null>(null);
  const words = loadingWords(useStage(frame, address), detail);
  return (
    <>
      <iframe ref={setFrame} src={address} title={title} className={styles.frame} />
      {words !== null && (
        <p className={styles.loading} role="status">
          {words}
        </p>
      )}
    </>
  );
}

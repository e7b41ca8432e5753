/** A scene in its frame, live or recorded, and what is awaited until it can be seen. */
import { useEffect, useState } from "react";
import type { Detail } from "./detail";
import { loadingWords, useStage } from "./loading";
import styles from "./ScenePanel.module.css";

interface SceneFrameProps {
  readonly address: string;
  readonly detail: Detail;
  readonly title: string;
  /** Told whether robot and target can be seen; false when it is no longer there, too. */
  readonly onDrawn?: ((drawn: boolean) => void) | undefined;
}

export function SceneFrame({ address, detail, title, onDrawn }: SceneFrameProps) {
  const [frame, setFrame] = useState<HTMLIFrameElement | null>(null);
  const stage = useStage(frame, address);
  const words = loadingWords(stage, detail);
  useEffect(() => {
    if (stage !== "drawn") return undefined;
    onDrawn?.(true);
    return () => onDrawn?.(false);
  }, [stage, address, onDrawn]);
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

/** From where a scene is looked at, and which of its layers are drawn. */
import { Button, Checkbox, SegmentedControl } from "@mantine/core";
import { useState } from "react";
import type { SceneChange, SceneView } from "../../api/types";
import { Popup } from "../../ui/Popup";
import { SceneLegend } from "./SceneLegend";
import styles from "./ScenePanel.module.css";

type Camera = SceneView["camera"];

interface SceneChoicesProps {
  readonly view: SceneView;
  readonly onChange: (change: SceneChange) => void;
  /** Why it may not be changed; null if it may. */
  readonly disabledReason: string | null;
}

const CAMERA_WORDS: Readonly<Record<Camera, string>> = { perspective: "All", top: "Top", follow: "Follow", hand: "Hand" };

export function SceneChoices({ view, onChange, disabledReason }: SceneChoicesProps) {
  // What was chosen here since the source last reported the arrangement.
  const [chosen, setChosen] = useState<SceneChange>({});
  const [known, setKnown] = useState(view);
  if (known !== view) {
    setKnown(view);
    setChosen({});
  }
  const layers = { ...view.layers, ...chosen.layers };
  const change = (next: SceneChange): void => {
    setChosen((before) => ({ ...before, ...next, layers: { ...before.layers, ...next.layers } }));
    onChange(next);
  };
  return (
    <div className={styles.choices} title={disabledReason ?? undefined}>
      <SegmentedControl
        aria-label="Camera"
        size="xs"
        disabled={disabledReason !== null}
        value={chosen.camera ?? view.camera}
        data={view.cameras.map((name) => ({ value: name, label: CAMERA_WORDS[name] }))}
        onChange={(camera) => { change({ camera }); }}
      />
      <Popup
        target={
          <Button size="compact-xs" disabled={disabledReason !== null}>
            Layers
          </Button>
        }
      >
        <fieldset className={styles.layers}>
          <legend>Layers</legend>
          {Object.entries(layers).map(([layer, drawn]) => (
            <Checkbox key={layer} size="xs" label={layer} checked={drawn} onChange={(event) => { change({ layers: { [layer]: event.currentTarget.checked } }); }} />
          ))}
        </fieldset>
      </Popup>
      <SceneLegend />
    </div>
  );
}

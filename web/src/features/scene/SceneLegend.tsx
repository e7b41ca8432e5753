/** What the marks of the scene mean, and to what scale its arrows are drawn. */
import { Button } from "@mantine/core";
import { Popup } from "../../ui/Popup";
import styles from "./SceneLegend.module.css";

/** Colours and scales of server/scene: palette.py, arrows.py, dynamics.py. */
const MARKS: readonly (readonly [sign: string, name: string, words: string])[] = [
  ["force", "Yellow arrow at a tip", "force of the target on the tip, 15 cm for 1 N"],
  ["momentum", "Pink arrow at the target", "its momentum, 10 cm for 0.1 N·s"],
  ["spin", "Green arc around the target", "how far it turns in a second"],
  ["ellipse", "Ellipse at a wrist", "the speeds its arm can give the hand; flat: near a singularity"],
  ["ghost", "Dashed box", "where the target is expected when the plan ends"],
  ["goal", "Dashed line with a pale hand", "the planned path of a hand, and where it ends"],
  ["touch", "Bright side with a dot", "the side of the target that a hand will press on, and where first"],
  ["reach", "Dashed arc about a shoulder", "how far its wrist reaches; layer reach"],
  ["future", "Violet lines and hands", "the most likely future of a rehearsal, and where it ends"],
  ["worst", "Red lines", "its worst future; faint lines are others"],
  ["trail", "Lines on the table", "where the target and the hands have been"],
  ["cage", "Green fence between the tips", "the cage: faint while open, bright when closed, solid when locked"],
];

export function SceneLegend() {
  return (
    <Popup target={<Button size="compact-xs">Legend</Button>}>
      <dl className={styles.legend} aria-label="Legend of the scene">
        {MARKS.map(([sign, name, words]) => (
          <div key={sign}>
            <dt>
              <i className={styles.mark} data-sign={sign} aria-hidden="true" />
              {name}
            </dt>
            <dd>{words}</dd>
          </div>
        ))}
      </dl>
    </Popup>
  );
}

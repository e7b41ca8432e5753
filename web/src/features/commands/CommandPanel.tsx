/** The panel of commands. */
import { useId, useState } from "react";
import { Panel } from "../../ui/Panel";
import { useKept } from "../../ui/use-kept";
import { useNamedConfigurations } from "../../store/configuration";
import { useSnapshot } from "../../store/context";
import { noGoOf, useLookAhead } from "../lookahead/look-ahead";
import { LookAheadLine } from "../lookahead/LookAheadLine";
import { useWhatIsLost } from "../mission/lost";
import { Choice } from "../../ui/Choice";
import { AnswerLine } from "./AnswerLine";
import { CAPTURE, RESET, SEQUENCE } from "./catalogue";
import { CommandButton } from "./CommandButton";
import styles from "./CommandPanel.module.css";
import { SimulationControls } from "./SimulationControls";

function ResetRow() {
  const configurations = useNamedConfigurations();
  const current = useSnapshot((snapshot) => snapshot.configuration.replace(" (edited)", "")) ?? "";
  const [chosen, setChosen] = useState<string | null>(null);
  const lost = useWhatIsLost();
  const name = chosen ?? current;
  const description = configurations.find((configuration) => configuration.name === name)?.description ?? "";
  return (
    <div className={styles.reset}>
      <Choice
        aria-label="Configuration to reset to"
        title={description}
        value={name}
        data={name === "" ? [""] : configurations.map((configuration) => configuration.name)}
        onChange={setChosen}
      />
      <CommandButton words={RESET} icon="reset" request={{ configuration: name }} warning={lost} />
    </div>
  );
}

/** The capture, and how it is foreseen to end: what is no-go takes a second press, with the reason. */
function CaptureRow() {
  const ahead = useLookAhead();
  return (
    <>
      <CommandButton words={CAPTURE} variant="filled" size="md" className={styles.capture ?? ""} warning={noGoOf(ahead, CAPTURE.command)} />
      <LookAheadLine ahead={ahead} />
    </>
  );
}

/** What may be done now; folded away, it leaves its room to the parameters. STOP is not among it. */
export function CommandPanel() {
  const real = useSnapshot((snapshot) => snapshot.plant.kind === "zenoh") ?? false;
  const [fold, setFold] = useKept("becalm-commands", "open", ["open", "folded"]);
  const folded = fold === "folded";
  const body = useId();
  const toggle = (
    <button
      type="button"
      className={styles.fold}
      aria-expanded={!folded}
      aria-controls={body}
      onClick={() => {
        setFold(folded ? "open" : "folded");
      }}
    >
      {folded ? "Show" : "Hide"}
      <span className="visually-hidden"> commands</span>
    </button>
  );
  return (
    <Panel title="Commands" aside={toggle}>
      <div id={body} hidden={folded}>
        <div className={styles.commands}>
          <CaptureRow />
          <div className={styles.sequence}>
            {SEQUENCE.map((words) => (
              <CommandButton key={words.command} words={words} />
            ))}
          </div>
          <ResetRow />
        </div>
        {real ? <p className={styles.real}>A real robot, in real time. A command that moves it takes two presses: the first arms it for a few seconds.</p> : <SimulationControls />}
      </div>
      <AnswerLine />
    </Panel>
  );
}

/** Mission time of a simulated plant: pause, run, step, speed. */
import { useState } from "react";
import { useSnapshot, useView } from "../../store/context";
import { Choice } from "../../ui/Choice";
import { fixed } from "../../units/units";
import { useReasonAgainstCommanding } from "../control/control";
import { BACK, PAUSE, RUN, speedsWith, STEP } from "./catalogue";
import { CommandButton, reasonAgainst } from "./CommandButton";
import styles from "./CommandPanel.module.css";
import { useDesk } from "./context";

const TICKS = ["1", "10", "100", "1000"];

function backRefusal(running: boolean, tick: number): string | null {
  if (running) return "Pause the clock first.";
  return tick < 2 ? "There is nothing to go back to." : null;
}

/** How fast it goes: drawn by itself, as it changes all the time. */
function Pace() {
  const words = useView(({ trust, snapshot }) => {
    if (trust !== "live" || snapshot === null) return "";
    return snapshot.plant.running ? `running at ${fixed(snapshot.plant.real_time_factor, 2)} ×` : "paused";
  });
  return (
    <h3>
      Simulation <span>{words}</span>
    </h3>
  );
}

/** While the clock runs it does not matter at which tick it is. */
function BackButton({ ticks }: { readonly ticks: number }) {
  const running = useSnapshot((snapshot) => snapshot.plant.running) ?? false;
  const tick = useSnapshot((snapshot) => (snapshot.plant.running ? 0 : snapshot.tick)) ?? 0;
  return <CommandButton words={BACK} icon="back" request={{ tick: Math.max(1, tick + 1 - ticks) }} disabledReason={backRefusal(running, tick)} />;
}

export function SimulationControls() {
  const desk = useDesk();
  const running = useSnapshot((snapshot) => snapshot.plant.running) ?? false;
  const speed = useSnapshot((snapshot) => snapshot.plant.speed) ?? 1;
  const untrusted = useView((view) => (view.trust === "live" ? null : reasonAgainst(view, "run")));
  const byWho = useReasonAgainstCommanding();
  const [chosen, setChosen] = useState<string | null>(null);
  const [ticks, setTicks] = useState("1");

  const choose = (value: string): void => {
    // The list stays as it is while data are late for a moment; what is chosen then is not sent, and the page says why.
    if (untrusted !== null) {
      desk.explain("run", untrusted);
      return;
    }
    // While time stands still the speed is only noted, for the next Run.
    setChosen(running ? null : value);
    if (running) void desk.send({ command: "run", speed: Number(value) });
  };

  return (
    <div className={styles.simulation}>
      <Pace />
      {running ? (
        <CommandButton words={PAUSE} icon="pause" />
      ) : (
        <CommandButton words={RUN} icon="play" request={{ speed: Number(chosen ?? speed) }} />
      )}
      <Choice
        aria-label="Simulation speed"
        disabled={byWho !== null}
        title={byWho ?? undefined}
        value={chosen ?? String(speed)}
        data={speedsWith(speed)}
        onChange={choose}
      />
      <div className={styles.steps}>
        <BackButton ticks={Number(ticks)} />
        <CommandButton words={STEP} icon="step" request={{ ticks: Number(ticks) }} />
      </div>
      <Choice
        aria-label="Ticks per step"
        value={ticks}
        data={TICKS.map((value) => ({ value, label: value === "1" ? "1 tick" : `${value} ticks` }))}
        onChange={setTicks}
      />
    </div>
  );
}

/** The live mission: act on the left, see in the middle, know on the right. */
import { CommandPanel } from "../features/commands/CommandPanel";
import { EventLog } from "../features/events/EventLog";
import { ProblemList } from "../features/events/ProblemList";
import { MissionStrip } from "../features/mission/MissionStrip";
import { ParameterPanel } from "../features/parameters/ParameterPanel";
import { PlotPanel } from "../features/plots/PlotPanel";
import { RunPanel } from "../features/runs/RunPanel";
import { ScenePanel } from "../features/scene/ScenePanel";
import styles from "./MissionPage.module.css";

export function MissionPage({ shown }: { readonly shown: boolean }) {
  return (
    <div className={styles.page} hidden={!shown}>
      <MissionStrip />
      <main className={styles.main}>
        <div className={styles.act}>
          <CommandPanel />
          <ParameterPanel />
        </div>
        <div className={styles.see}>
          <ScenePanel />
          <PlotPanel />
        </div>
        <div className={styles.know}>
          <RunPanel />
          <ProblemList />
          <EventLog />
        </div>
      </main>
    </div>
  );
}

/** The live mission: act on the left, see in the middle, know on the right. */
import { useState } from "react";
import { CommandDesk } from "../features/commands/desk";
import { CommandPanel } from "../features/commands/CommandPanel";
import { DeskContext } from "../features/commands/context";
import { EventLog } from "../features/events/EventLog";
import { ProblemList } from "../features/events/ProblemList";
import { MissionStrip } from "../features/mission/MissionStrip";
import { ParameterPanel } from "../features/parameters/ParameterPanel";
import { PlotPanel } from "../features/plots/PlotPanel";
import { RunPanel } from "../features/runs/RunPanel";
import { ScenePanel } from "../features/scene/ScenePanel";
import { ConfigurationContext, useConfigurationState } from "../store/configuration";
import { useView } from "../store/context";
import styles from "./MissionPage.module.css";
import { TopBar } from "./TopBar";
import { TrustNotice } from "./TrustNotice";

export function MissionPage() {
  const trust = useView((view) => view.trust);
  const [desk] = useState(() => new CommandDesk());
  const configuration = useConfigurationState();
  return (
    <DeskContext value={desk}>
      <ConfigurationContext value={configuration}>
      <div className={styles.page} data-trust={trust}>
        <TopBar />
        <MissionStrip />
        <main className={styles.main}>
          <div className={styles.act}>
            <CommandPanel />
            <ParameterPanel />
          </div>
          <div className={styles.see}>
            <TrustNotice />
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
      </ConfigurationContext>
    </DeskContext>
  );
}

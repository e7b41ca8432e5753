/** The live mission: act on the left, see in the middle, know on the right. */
import { Suspense, useMemo, useRef, type CSSProperties, type ReactNode } from "react";
import { CommandPanel } from "../features/commands/CommandPanel";
import { EventLog } from "../features/events/EventLog";
import { ProblemList } from "../features/events/ProblemList";
import { MissionStrip } from "../features/mission/MissionStrip";
import { ParameterPanel } from "../features/parameters/ParameterPanel";
import { PlotPanel } from "../features/plots/PlotPanel";
import { LivePrediction } from "../features/rehearsal/Predicted";
import { RehearsalPanel } from "../features/rehearsal/RehearsalPanel";
import { RehearseButton } from "../features/rehearsal/RehearseButton";
import { RunPanel } from "../features/runs/RunPanel";
import { ScenePanel } from "../features/scene/ScenePanel";
import { Divider } from "../ui/Divider";
import { WallView } from "./later";
import { BOUNDS, useLayout, withSize, type Layout, type Size } from "./layout";
import styles from "./MissionPage.module.css";
import { arrangementOf, moved, textOf, type PanelName, type Place } from "./panels/arrangement";
import { PanelPlace, Panels, useHosts } from "./panels/Panels";

/** What is not chosen is laid out by the style sheet. */
function variablesOf({ left, right, plots }: Layout): CSSProperties {
  const variables: CSSProperties & Record<string, string> = {};
  if (left !== null) variables["--left-width"] = `${left}px`;
  if (right !== null) variables["--right-width"] = `${right}px`;
  if (plots !== null) variables["--plots-height"] = `${plots}%`;
  return variables;
}

const LABELS: Readonly<Record<Size, string>> = { left: "Width of the left column", right: "Width of the right column", plots: "Height of the plots" };

/** In the gap between two panels; the value is that of the panel that it measures. */
function Between({ size, layout, onLayout, measured }: { readonly size: Size; readonly layout: Layout; readonly onLayout: (layout: Layout) => void; readonly measured: () => DOMRect | undefined }) {
  const [least, most] = BOUNDS[size];
  const valueAt = (x: number, y: number): number => {
    const box = measured();
    if (box === undefined) return least;
    if (size === "plots") return (100 * (box.bottom - y)) / box.height;
    return size === "left" ? x - box.left : box.right - x;
  };
  return (
    <Divider
      label={LABELS[size]}
      orientation={size === "plots" ? "horizontal" : "vertical"}
      value={layout[size] ?? (size === "plots" ? 45 : 296)}
      bounds={[least, most]}
      step={size === "plots" ? 2 : 16}
      valueAt={valueAt}
      grows={size === "left"}
      onChange={(value) => { onLayout(withSize(layout, size, value)); }}
    />
  );
}

const PANELS: Readonly<Record<PanelName, ReactNode>> = {
  commands: <CommandPanel />,
  parameters: <ParameterPanel beside={<RehearseButton />} />,
  outcome: <RunPanel />,
  problems: <ProblemList />,
  rehearsal: <RehearsalPanel />,
  events: <EventLog />,
};

function Columns({ layout, onLayout, children }: { readonly layout: Layout; readonly onLayout: (layout: Layout) => void; readonly children: ReactNode }) {
  const main = useRef<HTMLElement>(null);
  const see = useRef<HTMLDivElement>(null);
  const inner = (): DOMRect | undefined => {
    const box = main.current?.getBoundingClientRect();
    return box && new DOMRect(box.x + 8, box.y, box.width - 16, box.height);
  };
  const arrangement = useMemo(() => arrangementOf(layout.panels), [layout.panels]);
  const hosts = useHosts();
  const move = (name: PanelName, place: Place): void => { onLayout({ ...layout, panels: textOf(moved(arrangement, name, place)) }); };
  return (
    <main ref={main} className={styles.main} style={variablesOf(layout)} hidden={layout.view === "wall"}>
      <div className={styles.act} data-column="act">
        <PanelPlace column="act" hosts={hosts} arrangement={arrangement} className={styles.column} />
      </div>
      <Between size="left" layout={layout} onLayout={onLayout} measured={inner} />
      <div ref={see} className={styles.see} data-column="see">
        <ScenePanel />
        <Between size="plots" layout={layout} onLayout={onLayout} measured={() => see.current?.getBoundingClientRect()} />
        {children}
        <PanelPlace column="see" hosts={hosts} arrangement={arrangement} className={styles.below} />
      </div>
      <Between size="right" layout={layout} onLayout={onLayout} measured={inner} />
      <div className={styles.know} data-column="know">
        <PanelPlace column="know" hosts={hosts} arrangement={arrangement} className={styles.column} />
      </div>
      <Panels hosts={hosts} panels={PANELS} arrangement={arrangement} onMove={move} />
    </main>
  );
}

export function MissionPage({ shown }: { readonly shown: boolean }) {
  const [layout, setLayout] = useLayout();
  return (
    <div className={styles.page} hidden={!shown} data-view={layout.view}>
      {layout.view === "wall" ? shown && <Suspense fallback={null}><WallView /></Suspense> : <MissionStrip />}
      <Columns layout={layout} onLayout={setLayout}>
        <LivePrediction>
          <PlotPanel />
        </LivePrediction>
      </Columns>
    </div>
  );
}

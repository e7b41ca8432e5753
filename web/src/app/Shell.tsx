/** The frame of every page: who and what at the top, one page below. STOP stands outside of it (src/stop). */
import { LibraryPage } from "../features/library/LibraryPage";
import { LinkPage } from "../features/link/LinkPage";
import { StudiesPage } from "../features/studies/StudiesPage";
import { useEffect } from "react";
import { tellPhase } from "../stop/events";
import { useView } from "../store/context";
import { Boundary } from "./Boundary";
import { MissionPage } from "./MissionPage";
import { useRoute } from "./route";
import styles from "./Shell.module.css";
import { TopBar } from "./TopBar";

/** What STOP shows of its answer depends on it; that it stops does not. */
function useTellPhase(): void {
  const phase = useView((view) => (view.trust === "live" ? (view.snapshot?.phase ?? null) : null));
  useEffect(() => {
    tellPhase(phase);
  }, [phase]);
}

/** Pages stay as they are while another one is shown: the scene keeps its view, a form what was typed. */
export function Shell() {
  const trust = useView((view) => view.trust);
  const robotSilent = useView((view) => view.robotAge > 0);
  const { page, item, other } = useRoute();
  useTellPhase();
  return (
    <div className={styles.shell} data-trust={trust} data-robot={robotSilent ? "silent" : undefined}>
      <TopBar page={page} />
      <Boundary what="The mission's page">
        <MissionPage shown={page === "mission"} />
      </Boundary>
      <Boundary what="The page of runs">
        <LibraryPage shown={page === "runs"} item={page === "runs" ? item : ""} other={page === "runs" ? other : ""} />
      </Boundary>
      <Boundary what="The page of studies">
        <StudiesPage shown={page === "studies"} item={page === "studies" ? item : ""} />
      </Boundary>
      <Boundary what="The page of the link">
        <LinkPage shown={page === "link"} />
      </Boundary>
    </div>
  );
}

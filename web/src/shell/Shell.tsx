/** The frame of every page: where one can go and who one is, how far the data are to be trusted, one page below. STOP
 * stands outside of it (src/stop). */
import { useEffect } from "react";
import { LibraryPage } from "../features/library/LibraryPage";
import { LinkPage } from "../features/link/LinkPage";
import { StudiesPage } from "../features/studies/StudiesPage";
import { announcePhase } from "../stop/events";
import { useDataState, useView } from "../store/context";
import { Boundary } from "../ui/Boundary";
import { MissionPage } from "./MissionPage";
import { useRoute } from "../store/route";
import styles from "./Shell.module.css";
import { StatusLine } from "./StatusLine";
import { TopBar } from "./TopBar";

/** What STOP shows of its answer depends on it; that it stops does not. */
function useAnnouncePhase(): void {
  const phase = useView((view) => (view.trust === "live" ? (view.snapshot?.phase ?? null) : null));
  useEffect(() => {
    announcePhase(phase);
  }, [phase]);
}

/** Pages stay as they are while another one is shown: the scene keeps its view, a form what was typed. */
export function Shell() {
  const state = useDataState();
  const { page, item, other } = useRoute();
  useAnnouncePhase();
  return (
    <div className={styles.shell} {...state}>
      <div className={styles.head}>
        <Boundary what="The top bar">
          <TopBar page={page} />
        </Boundary>
        <Boundary what="The status line">
          <StatusLine phased={page !== "mission"} />
        </Boundary>
      </div>
      <div className={styles.body}>
        <Boundary what="The mission page">
          <MissionPage shown={page === "mission"} />
        </Boundary>
        <Boundary what="The runs page">
          <LibraryPage shown={page === "runs"} item={page === "runs" ? item : ""} other={page === "runs" ? other : ""} />
        </Boundary>
        <Boundary what="The studies page">
          <StudiesPage shown={page === "studies"} item={page === "studies" ? item : ""} />
        </Boundary>
        <Boundary what="The link page">
          <LinkPage shown={page === "link"} />
        </Boundary>
      </div>
    </div>
  );
}

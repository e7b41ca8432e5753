/** The frame of every page: who and what at the top, STOP within reach, one page below. */
import { LibraryPage } from "../features/library/LibraryPage";
import { LinkPage } from "../features/link/LinkPage";
import { StudiesPage } from "../features/studies/StudiesPage";
import { useView } from "../store/context";
import { Boundary } from "./Boundary";
import { MissionPage } from "./MissionPage";
import { useRoute } from "./route";
import styles from "./Shell.module.css";
import { TopBar } from "./TopBar";

/** Pages stay as they are while another one is shown: the scene keeps its view, a form what was typed. */
export function Shell() {
  const trust = useView((view) => view.trust);
  const { page, item, other } = useRoute();
  return (
    <div className={styles.shell} data-trust={trust}>
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

/** The frame of every page: where one can go and who one is, how far the data are to be trusted, one page below. STOP
 * stands outside of it (src/stop). */
import { Suspense, useCallback, useEffect, useState } from "react";
import { useAnnouncements } from "../features/alarms/announce";
import { OVERLAY } from "../features/library/overlay-address";
import { announcePhase } from "../stop/events";
import { useDataState, useView } from "../store/context";
import { Boundary } from "../ui/Boundary";
import { useContrast } from "../ui/theme/contrast";
import { Keys } from "./Keys";
import { useLayoutAddress } from "./layout";
import { AlarmsPage, AtlasPage, Later, LibraryPage, LinkPage, OverlayPage, readAhead, StudiesPage, Tour } from "./later";
import { MissionPage } from "./MissionPage";
import { useRoute, type Route } from "../store/route";
import styles from "./Shell.module.css";
import { StatusLine } from "./StatusLine";
import { TopBar } from "./TopBar";
import { onTour } from "./tour/open";

/** What STOP shows of its answer depends on it; that it stops does not. */
function useAnnouncePhase(): void {
  const phase = useView((view) => (view.trust === "live" ? (view.snapshot?.phase ?? null) : null));
  useEffect(() => {
    announcePhase(phase);
  }, [phase]);
}

/** What opens over whatever page is shown. */
function Over() {
  const [touring, setTouring] = useState(false);
  const endTour = useCallback(() => { setTouring(false); }, []);
  useEffect(() => onTour(() => { setTouring(true); }), []);
  return (
    <>
      <Keys />
      <Suspense fallback={null}>{touring && <Tour onEnd={endTour} />}</Suspense>
    </>
  );
}

/** Pages stay as they are while another one is shown: the scene keeps its view, a form what was typed. */
function Pages({ page, item, other }: Route) {
  const overlaid = page === "runs" && item === OVERLAY;
  return (
    <div className={styles.body}>
      <Boundary what="The mission page">
        <MissionPage shown={page === "mission"} />
      </Boundary>
      <Boundary what="The runs page">
        <Later shown={page === "runs" && !overlaid}>
          <LibraryPage shown={page === "runs" && !overlaid} item={page === "runs" && !overlaid ? item : ""} other={page === "runs" ? other : ""} />
        </Later>
      </Boundary>
      <Boundary what="The plot of several runs">
        <Later shown={overlaid}>
          <OverlayPage shown={overlaid} />
        </Later>
      </Boundary>
      <Boundary what="The studies page">
        <Later shown={page === "studies"}>
          <StudiesPage shown={page === "studies"} item={page === "studies" ? item : ""} other={page === "studies" ? other : ""} />
        </Later>
      </Boundary>
      <Boundary what="The atlas page">
        <Later shown={page === "atlas"}>
          <AtlasPage shown={page === "atlas"} item={page === "atlas" ? item : ""} />
        </Later>
      </Boundary>
      <Boundary what="The alarms page">
        <Later shown={page === "alarms"}>
          <AlarmsPage shown={page === "alarms"} />
        </Later>
      </Boundary>
      <Boundary what="The link page">
        <Later shown={page === "link"}>
          <LinkPage shown={page === "link"} />
        </Later>
      </Boundary>
    </div>
  );
}

export function Shell() {
  const state = useDataState();
  const route = useRoute();
  useAnnouncePhase();
  useAnnouncements();
  useLayoutAddress();
  useContrast();
  useEffect(readAhead, []);
  return (
    <div className={styles.shell} {...state}>
      <div className={styles.head}>
        <Boundary what="The top bar">
          <TopBar page={route.page} />
        </Boundary>
        <Boundary what="The status line">
          <StatusLine phased={route.page !== "mission"} />
        </Boundary>
      </div>
      <Pages {...route} />
      <Boundary what="The keys">
        <Over />
      </Boundary>
    </div>
  );
}

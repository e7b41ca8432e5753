/** Ties the service's telemetry to the store while the page is open. */
import { useEffect, useState } from "react";
import { readEvents, readHealth, readHistory } from "../api/service";
import { LiveSource, telemetrySocket } from "../source/live";
import { MissionStore } from "../store/mission";

const RATE = 60;
const LOOK_PERIOD = 100;
/** Milliseconds between two looks at the service's health: often when something is amiss. */
const HEALTH_PERIOD = { calm: 3000, amiss: 1000 };

function watchHealth(store: MissionStore): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let ended = false;
  const look = async (): Promise<void> => {
    const asked = performance.now();
    const health = await readHealth().catch(() => null);
    if (ended) return;
    store.health(health, asked);
    timer = setTimeout(() => void look(), store.read().trust === "live" ? HEALTH_PERIOD.calm : HEALTH_PERIOD.amiss);
  };
  void look();
  return () => {
    ended = true;
    clearTimeout(timer);
  };
}

/** A browser that joins late, or missed a while, reads the events of the run from the library. */
function watchRun(store: MissionStore): () => void {
  let known = "";
  return store.subscribe(() => {
    const { snapshot, trust, missed } = store.read();
    const id = trust === "live" ? (snapshot?.run_id ?? "") : "";
    if (`${id} ${missed}` === known) return;
    known = `${id} ${missed}`;
    if (id === "") return;
    readEvents(id).then(
      (events) => {
        if (store.read().snapshot?.run_id === id) store.addEvents(events);
      },
      // The log then begins with what telemetry tells; the next connection asks again.
      () => undefined,
    );
  });
}

/** The store of the live mission, fed as long as the component stands. */
export function useLiveMission(): MissionStore {
  const [store] = useState(() => new MissionStore());
  useEffect(() => {
    const source = new LiveSource({ connect: () => telemetrySocket(RATE), readHistory });
    const ends = [watchHealth(store), watchRun(store), source.open(store)];
    const clock = setInterval(store.look, LOOK_PERIOD);
    return () => {
      clearInterval(clock);
      for (const end of ends) end();
    };
  }, [store]);
  return store;
}

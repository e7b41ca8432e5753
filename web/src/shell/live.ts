/** Ties the service's telemetry to the store while the page is open. */
import { useQuery } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { readHealth } from "../api/service";
import type { Health } from "../api/types";
import { LiveSource } from "../source/live-source";
import { MissionStore } from "../store/mission";

const CHECK_PERIOD = 100;
/** Milliseconds between two looks at the service's health: often when something is amiss. */
const HEALTH_PERIOD = { calm: 3000, amiss: 1000 };

/** No answer is an answer, too. */
async function askForHealth(store: MissionStore): Promise<Health | null> {
  const asked = performance.now();
  const health = await readHealth().catch(() => null);
  store.health(health, asked);
  return health;
}

/** The store of the live mission, fed as long as the component stands. */
export function useLiveMission(): MissionStore {
  const [store] = useState(() => new MissionStore(new LiveSource()));
  useQuery({
    queryKey: ["health"],
    queryFn: () => askForHealth(store),
    refetchInterval: () => (store.read().trust === "live" ? HEALTH_PERIOD.calm : HEALTH_PERIOD.amiss),
    refetchIntervalInBackground: true,
  });
  useEffect(() => {
    const end = store.open();
    const clock = setInterval(store.checkAge, CHECK_PERIOD);
    return () => {
      clearInterval(clock);
      end();
    };
  }, [store]);
  return store;
}

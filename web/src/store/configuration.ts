/** The configuration in force and its schema, read again whenever the mission says that they may have changed. */
import { keepPreviousData, useQuery, useQueryClient } from "@tanstack/react-query";
import { createContext, useContext, useEffect, useMemo } from "react";
import { readConfiguration, readConfigurationSchema, readNamedConfigurations } from "../api/service";
import type { MissionConfiguration, NamedConfiguration, Parameter } from "../api/types";
import { useStore, useView } from "./context";
import type { MissionView } from "./mission";

export interface Configuration {
  readonly parameters: readonly Parameter[];
  readonly inForce: MissionConfiguration | null;
  readonly setInForce: (inForce: MissionConfiguration) => void;
}

export const ConfigurationContext = createContext<Configuration>({
  parameters: [],
  inForce: null,
  setInForce: () => undefined,
});

export const useConfiguration = (): Configuration => useContext(ConfigurationContext);

/** Changes with the connection, the run, the configuration's name and every event about the configuration. */
function revisionOf(view: MissionView): string {
  const latest = view.events.findLast((event) => event.kind === "config");
  const { snapshot, connections } = view;
  return [connections, snapshot?.run_id, snapshot?.configuration, latest?.tick, latest?.message].join(" ");
}

const CONFIGURATION = ["configuration"];
const SCHEMA = [...CONFIGURATION, "schema"];
const IN_FORCE = [...CONFIGURATION, "in force"];

/** Of the live mission. Without an answer the form keeps what it has; the link's notice says so. */
export function useConfigurationState(): Configuration {
  const client = useQueryClient();
  const store = useStore();
  const revision = useView(revisionOf);
  const ready = useView((view) => view.link.state === "open" && view.snapshot !== null);
  const common = { enabled: ready, staleTime: Infinity };
  const parameters = useQuery({ ...common, queryKey: SCHEMA, queryFn: readConfigurationSchema }).data?.parameters;
  const inForce = useQuery({ ...common, queryKey: IN_FORCE, queryFn: readConfiguration }).data ?? null;

  useEffect(() => {
    if (ready) void client.invalidateQueries({ queryKey: CONFIGURATION });
  }, [client, ready, revision]);
  useEffect(() => {
    if (inForce !== null) store.config(inForce.config);
  }, [store, inForce]);

  return useMemo(
    () => ({
      parameters: parameters ?? [],
      inForce,
      setInForce: (configuration) => {
        client.setQueryData(IN_FORCE, configuration);
      },
    }),
    [client, parameters, inForce],
  );
}

/** The named configurations, asked for again with each connection; none while the service has not listed them. */
export function useNamedConfigurations(): readonly NamedConfiguration[] {
  const connections = useView((view) => view.connections);
  const { data } = useQuery({ queryKey: ["configurations", connections], queryFn: readNamedConfigurations, placeholderData: keepPreviousData, staleTime: Infinity });
  return data ?? [];
}

/** The configuration in force and its schema, read anew whenever the mission says that they may have changed. */
import { createContext, useContext, useEffect, useMemo, useState } from "react";
import { readConfiguration, readConfigurationSchema } from "../api/service";
import type { MissionConfiguration, Parameter } from "../api/types";
import { useView } from "./context";
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
  const { snapshot } = view;
  return [view.link.state, snapshot?.run_id, snapshot?.configuration, latest?.tick, latest?.message].join(" ");
}

export function useConfigurationState(): Configuration {
  const [parameters, setParameters] = useState<readonly Parameter[]>([]);
  const [inForce, setInForce] = useState<MissionConfiguration | null>(null);
  const revision = useView(revisionOf);
  const ready = useView((view) => view.link.state === "open" && view.snapshot !== null);

  useEffect(() => {
    if (!ready) return undefined;
    let wanted = true;
    Promise.all([readConfigurationSchema(), readConfiguration()]).then(
      ([schema, configuration]) => {
        if (!wanted) return;
        setParameters(schema.parameters);
        setInForce(configuration);
      },
      // The form keeps what it has when the service does not answer; the link's notice says so.
      () => undefined,
    );
    return () => {
      wanted = false;
    };
  }, [ready, revision]);

  return useMemo(() => ({ parameters, inForce, setInForce }), [parameters, inForce]);
}

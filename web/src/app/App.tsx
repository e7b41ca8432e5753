import { MantineProvider } from "@mantine/core";
import { useState } from "react";
import { DeskContext } from "../features/commands/context";
import { CommandDesk } from "../features/commands/desk";
import { ConfigurationContext, useConfigurationState } from "../store/configuration";
import { StoreContext } from "../store/context";
import { surfaces, theme } from "../theme/theme";
import { useLiveMission } from "./live";
import { PreferencesContext, usePreferencesState } from "./preferences";
import { Shell } from "./Shell";

/** What every page shares of the live mission: its commands and its configuration. */
function Mission() {
  const [desk] = useState(() => new CommandDesk());
  const configuration = useConfigurationState();
  return (
    <DeskContext value={desk}>
      <ConfigurationContext value={configuration}>
        <Shell />
      </ConfigurationContext>
    </DeskContext>
  );
}

export function App() {
  const store = useLiveMission();
  const preferences = usePreferencesState();
  return (
    <MantineProvider theme={theme} cssVariablesResolver={surfaces} defaultColorScheme="dark">
      <PreferencesContext value={preferences}>
        <StoreContext value={store}>
          <Mission />
        </StoreContext>
      </PreferencesContext>
    </MantineProvider>
  );
}

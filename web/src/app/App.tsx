import { MantineProvider } from "@mantine/core";
import { StoreContext } from "../store/context";
import { surfaces, theme } from "../theme/theme";
import { useLiveMission } from "./live";
import { MissionPage } from "./MissionPage";
import { PreferencesContext, usePreferencesState } from "./preferences";

export function App() {
  const store = useLiveMission();
  const preferences = usePreferencesState();
  return (
    <MantineProvider theme={theme} cssVariablesResolver={surfaces} defaultColorScheme="dark">
      <PreferencesContext value={preferences}>
        <StoreContext value={store}>
          <MissionPage />
        </StoreContext>
      </PreferencesContext>
    </MantineProvider>
  );
}

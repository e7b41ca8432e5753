import { MantineProvider } from "@mantine/core";
import { QueryClientProvider } from "@tanstack/react-query";
import { Suspense, useState, type ReactNode } from "react";
import { newQueryClient } from "../api/query-client";
import { AccessContext, useAccess, useAccessState } from "../features/access/session";
import { DeskContext } from "../features/commands/context";
import { CommandDesk } from "../features/commands/desk";
import { useDisarming } from "../features/commands/disarming";
import { StagingContext, useStagingState } from "../features/parameters/staging";
import { RehearsalContext } from "../features/rehearsal/context";
import { RehearsalDesk } from "../features/rehearsal/desk";
import { PlanContext, usePlanState } from "../features/rehearsal/plan";
import { ConfigurationContext, useConfigurationState } from "../store/configuration";
import { StoreContext } from "../store/context";
import { surfaces, theme } from "../ui/theme/theme";
import styles from "./App.module.css";
import { Boundary } from "../ui/Boundary";
import { SignIn } from "./later";
import { useLiveMission } from "./live";
import { PreferencesContext, usePreferencesState } from "../units/preferences";
import { Shell } from "./Shell";

/** What is staged for the live mission, and what has been rehearsed of it: both outlive the page that shows them. */
function Intentions({ children }: { readonly children: ReactNode }) {
  const [desk] = useState(() => new RehearsalDesk());
  return (
    <StagingContext value={useStagingState()}>
      <RehearsalContext value={desk}>
        <PlanContext value={usePlanState()}>{children}</PlanContext>
      </RehearsalContext>
    </StagingContext>
  );
}

/** What every page shares of the live mission: its commands and its configuration. */
function Mission() {
  const [desk] = useState(() => new CommandDesk());
  useDisarming(desk);
  const configuration = useConfigurationState();
  return (
    <DeskContext value={desk}>
      <ConfigurationContext value={configuration}>
        <Intentions>
          <Shell />
        </Intentions>
      </ConfigurationContext>
    </DeskContext>
  );
}

/** The live mission, connected to as long as this stands. */
function Console() {
  const store = useLiveMission();
  return (
    <StoreContext value={store}>
      <Mission />
    </StoreContext>
  );
}

/** Nothing of the mission before the service has said who one is; the sign-in if it asks for a token. */
function Gate() {
  const { session } = useAccess();
  if (session === null) return <p className={styles.waiting}>Waiting for the service to answer. STOP still works.</p>;
  return session.token_needed && session.role === null ? <Suspense fallback={null}><SignIn /></Suspense> : <Console />;
}

function SignedIn() {
  const access = useAccessState();
  return (
    <AccessContext value={access}>
      <Gate />
    </AccessContext>
  );
}

function Everything() {
  const [client] = useState(newQueryClient);
  const preferences = usePreferencesState();
  return (
    <MantineProvider theme={theme} cssVariablesResolver={surfaces} defaultColorScheme="dark">
      <QueryClientProvider client={client}>
        <PreferencesContext value={preferences}>
          <SignedIn />
        </PreferencesContext>
      </QueryClientProvider>
    </MantineProvider>
  );
}

/** Whatever all pages share may fail, too. */
export function App() {
  return (
    <Boundary what="The console" onReload={() => { location.reload(); }}>
      <Everything />
    </Boundary>
  );
}

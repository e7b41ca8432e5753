/** Who is signed in, and the way out. */
import { Button, Popover } from "@mantine/core";
import { readSession, signOut } from "../../api/service";
import { useAccess } from "./session";
import styles from "./Identity.module.css";

export function Identity() {
  const { session, setSession } = useAccess();
  if (session === null || !session.token_needed || session.name === null) return null;
  const leave = async (): Promise<void> => {
    await signOut();
    setSession(await readSession());
  };
  return (
    <Popover position="bottom-end" trapFocus>
      <Popover.Target>
        <Button variant="subtle" color="gray" className={styles.identity ?? ""} title="Signed in">
          {session.name} <small>{session.role}</small>
        </Button>
      </Popover.Target>
      <Popover.Dropdown>
        <Button onClick={() => void leave().catch(() => undefined)}>Sign out</Button>
      </Popover.Dropdown>
    </Popover>
  );
}

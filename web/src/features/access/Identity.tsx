/** Who is signed in, and the way out. */
import { Button } from "@mantine/core";
import { readSession, signOut } from "../../api/service";
import { Popup } from "../../ui/Popup";
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
    <Popup
      target={
        <Button variant="subtle" color="gray" className={styles.identity ?? ""} title={`Signed in as ${session.name}`}>
          <span className={styles.name}>{session.name}</span> <small>{session.role}</small>
        </Button>
      }
    >
      <Button onClick={() => void leave().catch(() => undefined)}>Sign out</Button>
    </Popup>
  );
}

/** Who is signed in, and the way out. */
import { Button } from "@mantine/core";
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
    <div className={styles.identity}>
      <span>
        {session.name} <small>{session.role}</small>
      </span>
      <Button onClick={() => void leave().catch(() => undefined)}>Sign out</Button>
    </div>
  );
}

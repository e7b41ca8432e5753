/** Asks for a token before anything of the mission is shown. */
import { Button, PasswordInput } from "@mantine/core";
import { useState } from "react";
import { addressOf } from "../../api/address";
import { Refusal } from "../../api/refusal";
import { signIn } from "../../api/service";
import { useAccess } from "./session";
import styles from "./SignIn.module.css";

export function SignIn() {
  const { setSession } = useAccess();
  const [token, setToken] = useState("");
  const [waiting, setWaiting] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const send = async (): Promise<void> => {
    setWaiting(true);
    try {
      setSession(await signIn(token.trim()));
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      setRefusal(cause);
    } finally {
      setWaiting(false);
    }
  };
  return (
    <main className={styles.page}>
      <form
        className={styles.form}
        onSubmit={(event) => {
          event.preventDefault();
          void send();
        }}
      >
        <img src={addressOf("/favicon.svg")} alt="" width={40} height={40} />
        <h1>Becalm</h1>
        <p>This console is open to other machines: sign in with your access token.</p>
        <PasswordInput
          label="Access token"
          placeholder="becalm_…"
          autoComplete="current-password"
          autoFocus
          value={token}
          error={refusal?.message}
          onChange={(event) => {
            setToken(event.currentTarget.value);
            setRefusal(null);
          }}
        />
        <Button type="submit" variant="filled" size="md" loading={waiting} disabled={token.trim() === ""}>
          Sign in
        </Button>
        <p className={styles.hint}>
          Whoever runs the service creates one with <code>becalm token create NAME --role operator</code>.
        </p>
      </form>
    </main>
  );
}

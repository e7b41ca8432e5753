/** Stands in whatever opens over the page: the key that closes it is the key that stops. */
import styles from "./ui.module.css";

export function EscNote() {
  return <p className={styles.esc}>Esc also stops the mission</p>;
}

/** What a page says while nothing of its kind is chosen. */
import styles from "./EmptyPage.module.css";

export function EmptyPage({ label, title, words }: { readonly label: string; readonly title: string; readonly words: string }) {
  return (
    <section className={styles.empty} aria-label={label}>
      <h2>{title}</h2>
      <p>{words}</p>
    </section>
  );
}

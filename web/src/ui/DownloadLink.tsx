/** A file to take away. */
import { Icon } from "./theme/Icon";
import styles from "./DownloadLink.module.css";

export function DownloadLink({ href, format, what }: { readonly href: string; readonly format: string; readonly what: string }) {
  return (
    <a className={styles.link} href={href} download aria-label={`Download ${what} as ${format}`}>
      <Icon icon="download" /> {format}
    </a>
  );
}

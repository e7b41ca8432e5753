/** A file to take away. */
import { Icon } from "./theme/Icon";
import styles from "./DownloadLink.module.css";

interface DownloadLinkProps {
  readonly href: string;
  readonly format: string;
  readonly what: string;
  /** What is read on it; the format without one. */
  readonly label?: string;
}

export function DownloadLink({ href, format, what, label = format }: DownloadLinkProps) {
  const told = `Download ${what} as ${format}`;
  return (
    <a className={styles.link} href={href} download aria-label={label === format ? told : `${label}: ${told}`}>
      <Icon icon="download" /> {label}
    </a>
  );
}

/** A titled region of the page. */
import { use, useId, type ReactNode } from "react";
import { PanelHandleContext } from "./panel-handle";
import styles from "./Panel.module.css";

interface PanelProps {
  readonly title: string;
  /** Stands at the title's right. */
  readonly aside?: ReactNode;
  /** Takes the room that is left, and scrolls within. */
  readonly grow?: boolean;
  /** Needs more than a few lines to be of use, also where room is short. */
  readonly tall?: boolean;
  /** Shows data that turn grey when they are old: of the service, or with a robot as old as what it told. */
  readonly dated?: "service" | "robot" | undefined;
  readonly children: ReactNode;
}

export function Panel({ title, aside, grow = false, tall = false, dated, children }: PanelProps) {
  const id = useId();
  const handle = use(PanelHandleContext);
  return (
    <section className={styles.panel} aria-labelledby={id} data-grow={grow || undefined} data-tall={tall || undefined}>
      <header className={styles.head}>
        <div className={styles.name}>
          {handle}
          <h2 id={id} className={styles.title}>
            {title}
          </h2>
        </div>
        {aside}
      </header>
      <div className={styles.body} data-dated={dated}>
        {children}
      </div>
    </section>
  );
}

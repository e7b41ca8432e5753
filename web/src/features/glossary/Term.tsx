/** A word with its meaning, shown where the pointer rests or the focus stands. */
import { Tooltip } from "@mantine/core";
import type { ReactNode } from "react";
import { meaningOf } from "./glossary";
import styles from "./Term.module.css";

/** `term` is looked up in the glossary; one that is not there is plain text. The tip describes it to a screen reader, too. */
export function Term({ term, children }: { readonly term: string; readonly children: ReactNode }) {
  const meaning = meaningOf(term);
  if (meaning === null) return <>{children}</>;
  return (
    <Tooltip label={meaning} w={280}>
      <span className={styles.term} tabIndex={0}>
        {children}
      </span>
    </Tooltip>
  );
}

/** A word with its meaning in a tip, for pointer, finger and keyboard. */
import { Tooltip } from "@mantine/core";
import type { ReactNode } from "react";
import { GLOSSARY, type GlossaryTerm } from "./glossary";
import styles from "./Term.module.css";

export function Term({ of, children }: { readonly of: GlossaryTerm; readonly children: ReactNode }) {
  return (
    <Tooltip label={GLOSSARY[of]} position="left">
      <span className={styles.term} tabIndex={0}>
        {children}
      </span>
    </Tooltip>
  );
}

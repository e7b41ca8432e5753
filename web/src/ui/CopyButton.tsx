/** Puts a text on the clipboard, and says that it has. */
import { Button } from "@mantine/core";
import { useEffect, useState } from "react";

interface CopyButtonProps {
  readonly label: string;
  readonly title: string;
  /** What is copied, asked for when the button is pressed. */
  readonly text: () => string;
  readonly compact?: boolean;
}

/** Milliseconds for which it says so. */
const SAYS_SO = 2000;

/** A page that came without TLS from another computer has no clipboard; the older way works there, too. */
function copiedBySelection(text: string): boolean {
  const field = document.createElement("textarea");
  field.value = text;
  field.setAttribute("readonly", "");
  field.style.position = "fixed";
  field.style.opacity = "0";
  document.body.append(field);
  field.select();
  // eslint-disable-next-line @typescript-eslint/no-deprecated -- there is no other way without a secure context
  const copied = document.execCommand("copy");
  field.remove();
  return copied;
}

async function copied(text: string): Promise<boolean> {
  if (!window.isSecureContext) return copiedBySelection(text);
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return copiedBySelection(text);
  }
}

export function CopyButton({ label, title, text, compact = false }: CopyButtonProps) {
  const [said, setSaid] = useState<string | null>(null);
  useEffect(() => {
    if (said === null) return undefined;
    const timer = setTimeout(() => {
      setSaid(null);
    }, SAYS_SO);
    return () => {
      clearTimeout(timer);
    };
  }, [said]);
  return (
    <Button
      size={compact ? "compact-xs" : "compact-sm"}
      title={title}
      onClick={() => {
        void copied(text()).then((done) => {
          setSaid(done ? "Copied" : "Not copied: see the address bar");
        });
      }}
    >
      <span role="status">{said ?? label}</span>
    </Button>
  );
}

/** A button that saves a figure as SVG, PNG or PDF, and its values as CSV. */
import { ActionIcon, Button, Menu } from "@mantine/core";
import { useState } from "react";
import { Icon } from "../theme/Icon";
import { EscNote } from "../EscNote";
import { FIGURE_FORMATS, type FigureFormat } from "./formats";
import { saveFile } from "./save-file";

const WORDS: Readonly<Record<FigureFormat, string>> = {
  svg: "SVG, to edit",
  png: "PNG, 300 dpi",
  pdf: "PDF, for a paper",
};

interface ExportMenuProps {
  /** What is saved, such as "the plot of tip forces". */
  readonly what: string;
  /** Of the file, without its ending. */
  readonly name: string;
  /** The figure as it is when it is asked for: markup of one `<svg>`. */
  readonly draw: () => string | Promise<string>;
  /** The same as a table with commas; without it there is none. */
  readonly table?: () => string | Promise<string>;
  /** An icon in place of the word, where room is short. */
  readonly compact?: boolean;
}

export function ExportMenu({ what, name, draw, table, compact = false }: ExportMenuProps) {
  const [trouble, setTrouble] = useState<string | null>(null);
  const attempt = (work: () => Promise<void>): void => {
    setTrouble(null);
    Promise.resolve()
      .then(work)
      .catch((cause: unknown) => {
        setTrouble(cause instanceof Error ? cause.message : String(cause));
      });
  };
  const spoken = { "aria-label": `Export ${what}`, title: trouble ?? `Export ${what}${table === undefined ? " as an image" : ""}` };
  return (
    <Menu position="bottom-end" withinPortal>
      <Menu.Target>
        {compact ? (
          <ActionIcon size={20} {...spoken}>
            <Icon icon={trouble === null ? "download" : "warning"} size={11} />
          </ActionIcon>
        ) : (
          <Button size="compact-xs" {...spoken}>
            {trouble === null ? "Export" : "Export failed"}
          </Button>
        )}
      </Menu.Target>
      <Menu.Dropdown>
        {FIGURE_FORMATS.map((format) => (
          <Menu.Item
            key={format}
            onClick={() => {
              attempt(async () => {
                const { saveFigure } = await import("./figure-file"); // read when the first figure is wanted
                await saveFigure(await draw(), name, format);
              });
            }}
          >
            {WORDS[format]}
          </Menu.Item>
        ))}
        {table !== undefined && (
          <Menu.Item
            onClick={() => {
              attempt(async () => {
                saveFile(new Blob([await table()], { type: "text/csv" }), `${name}.csv`);
              });
            }}
          >
            CSV, the values
          </Menu.Item>
        )}
        <EscNote />
      </Menu.Dropdown>
    </Menu>
  );
}

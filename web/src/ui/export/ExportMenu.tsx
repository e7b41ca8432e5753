/** A button that saves a figure as SVG, PNG or PDF. */
import { ActionIcon, Button, Menu } from "@mantine/core";
import { useState } from "react";
import { Icon } from "../theme/Icon";
import { EscNote } from "../EscNote";
import { FIGURE_FORMATS, saveFigure, type FigureFormat } from "./figure-file";

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
  readonly draw: () => string;
  /** An icon in place of the word, where room is short. */
  readonly compact?: boolean;
}

export function ExportMenu({ what, name, draw, compact = false }: ExportMenuProps) {
  const [trouble, setTrouble] = useState<string | null>(null);
  const save = (format: FigureFormat): void => {
    setTrouble(null);
    Promise.resolve()
      .then(() => saveFigure(draw(), name, format))
      .catch((cause: unknown) => {
        setTrouble(cause instanceof Error ? cause.message : String(cause));
      });
  };
  const spoken = { "aria-label": `Export ${what}`, title: trouble ?? `Export ${what} as an image` };
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
              save(format);
            }}
          >
            {WORDS[format]}
          </Menu.Item>
        ))}
        <EscNote />
      </Menu.Dropdown>
    </Menu>
  );
}

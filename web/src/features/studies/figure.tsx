/** A study's picture as a figure of its own: on white, with a title, and without what belongs to the page. */
import type { ReactNode } from "react";
import { flushSync } from "react-dom";
import { createRoot } from "react-dom/client";
import type { StudyDetail } from "../../api/types";
import type { Axis, Spread } from "./layout";
import type { PublishedClasses } from "./published";
import { columnTitle, StudyMap, type Caption, type Paper } from "./StudyMap";
import { StudyMarginals } from "./StudyMarginals";
import { StudyScatter } from "./StudyScatter";
import type { Rows } from "./use-study";

const WHITE: Paper = { page: "#ffffff", ink: "#12171e", dim: "#46515f", line: "#d3dae3", empty: "#e3e8ee" };

/** In CSS pixels: a page's width, and as high as the panels need. */
const FIGURE = { width: 960, height: 760 };

export interface FigureProps {
  readonly study: StudyDetail;
  readonly rows: Rows;
  readonly spread: Spread | null;
  readonly drawn: readonly Axis[];
  readonly chosen: ReadonlyMap<string, number>;
  readonly column: string;
  readonly published: PublishedClasses | null;
  /** Over each parameter alone, in place of the map. */
  readonly alone: boolean;
}

/** What stands above the figure: of which study it is, and of how much of it. */
export function captionOf({ study, column, spread, chosen }: FigureProps): Caption {
  const { configuration, direct } = study.definition as { configuration?: string; direct?: boolean };
  const { done, total } = study.progress;
  const shown = new Set([spread?.x.path, spread?.y?.path, spread?.facet?.path]);
  const held = study.axes.filter((axis) => axis.values !== null && axis.values.length > 1 && !shown.has(axis.path));
  const at = held.map((axis) => `${axis.path} = ${axis.values?.[chosen.get(axis.path) ?? 0] ?? ""}`);
  const cells = done === total ? `${total} cells` : `${done} of ${total} cells`;
  const words = [`configuration ${configuration ?? "published"}`, direct === true ? "direct caging" : "", cells, ...at, `study ${study.id}`];
  return { title: `${study.name}: ${columnTitle(study, column)}`, words: words.filter(Boolean).join(" · ") };
}

export function Figure(props: FigureProps): ReactNode {
  const { study, rows, spread, drawn, chosen, column, published } = props;
  if (props.alone) return <StudyMarginals study={study} rows={rows} column={column} paper={WHITE} frame={FIGURE} caption={captionOf({ ...props, spread: null })} />;
  const common = { study, rows, column, paper: WHITE, frame: FIGURE, selected: null, onSelect: null, caption: captionOf(props) };
  if (spread !== null) return <StudyMap {...common} spread={spread} chosen={chosen} published={published} />;
  return drawn[0] ? <StudyScatter {...common} x={drawn[0]} y={drawn[1] ?? null} /> : null;
}

/** Markup of the one `<svg>` of a figure. */
export function figureOf(props: FigureProps): string {
  const holder = document.createElement("div");
  const root = createRoot(holder);
  flushSync(() => {
    root.render(<Figure {...props} />);
  });
  const picture = holder.querySelector("svg");
  const markup = picture === null ? "" : new XMLSerializer().serializeToString(picture);
  root.unmount();
  return markup;
}

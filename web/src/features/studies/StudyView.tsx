/** One study: its state, its map, and what may be done with it. */
import { SegmentedControl, Switch, useMantineColorScheme } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { useState, type ReactNode } from "react";
import { readPublishedTables, resultsAddress, studyReportAddress } from "../../api/service";
import type { PublishedTables, StudyDetail } from "../../api/types";
import { DownloadLink } from "../../ui/DownloadLink";
import { Choice } from "../../ui/Choice";
import { ExportMenu } from "../../ui/export/ExportMenu";
import { figureOf } from "./figure";
import { axisName } from "./geometry";
import { gridAxes, usualSpread, type Spread } from "./layout";
import { publishedFor } from "./published";
import styles from "./StudiesPage.module.css";
import { columnTitle, StudyMap, type Paper } from "./StudyMap";
import { StudyMarginals } from "./StudyMarginals";
import { StudyScatter } from "./StudyScatter";
import type { Rows } from "./use-study";

export const PAPERS: Readonly<Record<"dark" | "light", Paper>> = {
  dark: { page: "#141920", ink: "#e9edf3", dim: "#a7b1bf", line: "#252d38", empty: "#232b36" },
  light: { page: "#fcfdfe", ink: "#12171e", dim: "#46515f", line: "#d3dae3", empty: "#e3e8ee" },
};

const CLASSES = ["outcome", "at_first_closure", "at_locked_arms", "caged"];

/** A study's name as part of a file's. */
const fileName = (name: string): string => name.replaceAll(/[^\p{L}\p{N}._-]+/gu, "-").slice(0, 80) || "study";

/** The columns that a map can show, classes first. */
function columnsOf(study: StudyDetail): { value: string; label: string }[] {
  const varied = new Set(study.axes.map((axis) => axis.path));
  return study.columns
    .filter((column) => !varied.has(column.name) && !["cell", "seed", "error"].includes(column.name))
    .map((column) => ({ value: column.name, label: columnTitle(study, column.name) }));
}

/** Without them the map stands alone. */
const usePublished = (): PublishedTables | null => useQuery({ queryKey: ["published tables"], queryFn: readPublishedTables, staleTime: Infinity }).data ?? null;

/** Where the axes go that are not spread, and what is put where. */
function AxisChoice({ study, spread, chosen, onSpread, onChosen }: {
  readonly study: StudyDetail;
  readonly spread: Spread;
  readonly chosen: ReadonlyMap<string, number>;
  readonly onSpread: (spread: Spread) => void;
  readonly onChosen: (chosen: ReadonlyMap<string, number>) => void;
}) {
  const axes = gridAxes(study);
  const find = (path: string) => axes.find((axis) => axis.path === path) ?? null;
  const rest = axes.filter((axis) => ![spread.x.path, spread.y?.path, spread.facet?.path].includes(axis.path));
  const swap = (role: "x" | "y" | "facet", path: string) => {
    const next = find(path);
    const other = (["x", "y", "facet"] as const).find((each) => spread[each]?.path === path);
    const swapped = { ...spread, ...(other === undefined ? {} : { [other]: spread[role] }), [role]: next };
    onSpread(swapped);
  };
  if (axes.length < 2) return null;
  return (
    <>
      {(["x", "y", "facet"] as const).map((role) =>
        spread[role] === null ? null : (
          <Choice key={role} aria-label={{ x: "Across", y: "Vertical", facet: "Panels" }[role]} value={spread[role].path} data={axes.map((axis) => ({ value: axis.path, label: `${{ x: "Across", y: "Vertical", facet: "Panels" }[role]}: ${axisName(axis.path)}` }))} onChange={(path) => { swap(role, path); }} />
        ),
      )}
      {rest.map((axis) => (
        <Choice key={axis.path} aria-label={axis.path} value={String(chosen.get(axis.path) ?? 0)} data={axis.values.map((value, place) => ({ value: String(place), label: `${axisName(axis.path)} = ${value}` }))} onChange={(place) => { onChosen(new Map(chosen).set(axis.path, Number(place))); }} />
      ))}
    </>
  );
}

/** What a study is coloured by at first. */
export const usualColumn = (study: StudyDetail): string => (study.agreement === null ? "outcome" : "at_first_closure");

export const LOOKS = ["map", "alone"] as const;
export type Look = (typeof LOOKS)[number];
const LOOK_WORDS: Readonly<Record<Look, string>> = { map: "Map", alone: "Each parameter" };

interface ViewProps {
  readonly study: StudyDetail;
  readonly rows: Rows;
  readonly column: string;
  readonly onColumn: (column: string) => void;
  readonly look: Look;
  readonly onLook: (look: Look) => void;
  /** What the colours of numbers span, where two studies stand beside one another; null: what there is. */
  readonly span: readonly [number, number] | null;
  readonly selected: number | null;
  readonly onSelect: (cell: number) => void;
  readonly head: ReactNode;
}

export function StudyView({ study, rows, column, onColumn, look, onLook, span, selected, onSelect, head }: ViewProps) {
  const { colorScheme } = useMantineColorScheme();
  const paper = PAPERS[colorScheme === "light" ? "light" : "dark"];
  const [spread, setSpread] = useState(() => usualSpread(study));
  const [chosen, setChosen] = useState<ReadonlyMap<string, number>>(new Map());
  const [compare, setCompare] = useState(true);
  const tables = usePublished();
  const { ref: holder, width, height } = useElementSize<HTMLDivElement>();
  const drawn = study.axes.filter((axis) => axis.values === null);
  const published = tables && spread ? publishedFor(tables, study, spread) : null;
  const beside = compare && CLASSES.includes(column) && column !== "caged" ? published : null;
  const frame = { width: Math.max(width, 1), height: Math.max(height, 1) };
  const alone = look === "alone";
  const draw = (): string => figureOf({ study, rows, spread, drawn, chosen, column, published: beside, alone });
  return (
    <section className={styles.view} aria-label={`Study ${study.name}`}>
      {head}
      <div className={styles.toolbar}>
        <SegmentedControl aria-label="How the study is drawn" value={look} data={LOOKS.map((value) => ({ value, label: LOOK_WORDS[value] }))} onChange={onLook} />
        <Choice aria-label="Colour by" value={column} data={columnsOf(study)} onChange={onColumn} />
        {spread && !alone && <AxisChoice study={study} spread={spread} chosen={chosen} onSpread={setSpread} onChosen={setChosen} />}
        {published && !alone && <Switch size="xs" label="show the paper's" checked={compare} onChange={(event) => { setCompare(event.currentTarget.checked); }} />}
        <span className={styles.spring} />
        <ExportMenu what="the map" name={`${fileName(study.name)}-${column}`} draw={draw} />
        <DownloadLink href={resultsAddress(study.id, "csv")} format="CSV" what="the table" />
        <DownloadLink href={resultsAddress(study.id, "parquet")} format="Parquet" what="the table" />
        <DownloadLink href={studyReportAddress(study.id, "html")} format="HTML" label="Report" what="the report of this study" />
        <DownloadLink href={studyReportAddress(study.id, "pdf")} format="PDF" label="Report, PDF" what="the report of this study" />
      </div>
      <div className={styles.picture}>
        <div className={styles.holder} ref={holder} data-scrolls={alone || undefined}>
          {alone ? (
            <StudyMarginals study={study} rows={rows} column={column} paper={paper} frame={frame} caption={null} span={span} />
          ) : spread ? (
            <StudyMap study={study} rows={rows} spread={spread} chosen={chosen} column={column} published={beside} paper={paper} frame={frame} selected={selected} onSelect={onSelect} span={span} caption={null} />
          ) : (
            drawn[0] && <StudyScatter study={study} rows={rows} x={drawn[0]} y={drawn[1] ?? null} column={column} paper={paper} frame={frame} selected={selected} onSelect={onSelect} caption={null} />
          )}
        </div>
      </div>
    </section>
  );
}

/** The atlas: what futures around the present state would come to over any two parameters. */
import { Progress, useMantineColorScheme } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useCallback, useMemo, useState } from "react";
import { cancelAtlas } from "../../api/service";
import { useAction } from "../../api/use-action";
import type { AtlasCell, AtlasDetail } from "../../api/types";
import { go } from "../../store/route";
import { Choice } from "../../ui/Choice";
import { EmptyPage } from "../../ui/EmptyPage";
import { clock, fixed, plain } from "../../units/units";
import { RoleButton } from "../access/RoleButton";
import { classStyle } from "../glossary/class-style";
import { useStaging } from "../parameters/staging";
import { requestWords } from "../rehearsal/words";
import { axisName } from "../studies/geometry";
import styles from "../studies/StudiesPage.module.css";
import { columnTitle, StudyMap } from "../studies/StudyMap";
import { PAPERS } from "../studies/StudyView";
import { detailOf, mappedOf, placeOf, placeOn, rowsOf, spanOf, spreadOf, surenessBy } from "./as-map";
import own from "./Atlas.module.css";
import { CellPanel } from "./CellPanel";
import { NewAtlas } from "./NewAtlas";
import { isUnderWay, useAtlas, type AtlasView } from "./use-atlas";

function stateWords({ status, progress, note }: AtlasDetail): string {
  const cells = `${progress.done} of ${progress.total} cells`;
  if (status === "queued") return `waiting, ${cells}`;
  if (status === "running" || status === "finished") return `${cells}, ${fixed(progress.wall_time, 1)} s`;
  return `${status}, ${cells}${note === null ? "" : `: ${note}`}`;
}

function Head({ atlas, onChange }: { readonly atlas: AtlasDetail; readonly onChange: () => Promise<unknown> }) {
  const { runAction, refusal } = useAction();
  return (
    <header className={`${styles.head} ${own.head}`}>
      <h2>{`${requestWords(atlas.request)} from ${clock(atlas.time)} ${atlas.run === null ? "on" : `of run …${atlas.run.slice(-6)}`}`}</h2>
      <span role="status">{stateWords(atlas)}</span>
      <span className={styles.spring} />
      {isUnderWay(atlas) && <Progress w={140} size={3} value={(100 * atlas.progress.done) / Math.max(1, atlas.progress.total)} aria-label="Progress of the atlas" />}
      {isUnderWay(atlas) && <RoleButton needs="operator" onClick={() => void runAction(() => cancelAtlas(atlas.id).then(onChange))}>Cancel</RoleButton>}
      {refusal && <p role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
    </header>
  );
}

/** A cell in one line, for whoever points at it. */
function readingOf(atlas: AtlasDetail, number: number | null, cell: AtlasCell | undefined): string {
  if (number === null) return "Point at a cell to read it; the arrow keys go from one to the next. The ring is the present point, and a cell is the paler the less sure it is.";
  const place = placeOf(atlas, number);
  const values = [[atlas.x, place.x] as const, [atlas.y, place.y] as const].map(([axis, at]) => `${axisName(axis.path)} ${plain(axis.values[at] ?? Number.NaN)}`);
  if (cell === undefined) return `${values.join(", ")}: not flown yet`;
  if (cell.error !== null) return `${values.join(", ")}: ${cell.error}`;
  const peak = cell.measures["peak_tip_force"];
  const force = typeof peak === "number" ? `, peak ${fixed(peak, 3)} N` : "";
  return `${values.join(", ")}: ${classStyle(cell.outcome ?? "").words} (${fixed(100 * cell.odds, 0)} %), ${cell.caged} of ${cell.futures} caged${force}`;
}

function AtlasMap({ atlas, view, selected, onSelect }: { readonly atlas: AtlasDetail; readonly view: AtlasView; readonly selected: number | null; readonly onSelect: (number: number) => void }) {
  const { colorScheme } = useMantineColorScheme();
  const [column, setColumn] = useState("outcome");
  const [pointed, setPointed] = useState<number | null>(null);
  const { ref: holder, width, height } = useElementSize<HTMLDivElement>();
  const { cells, readAgain } = view;
  const rows = useMemo(() => rowsOf(atlas, cells), [atlas, cells]);
  const sureness = useMemo(() => surenessBy(column), [column]);
  const mapped = mappedOf(atlas);
  const [x, y] = [placeOn(atlas.x), placeOn(atlas.y)];
  const shown = pointed ?? selected;
  return (
    <section className={styles.view} aria-label="Atlas">
      <Head atlas={atlas} onChange={readAgain} />
      <div className={styles.toolbar}>
        <Choice aria-label="Colour by" value={column} data={mapped.columns.map(({ name }) => ({ value: name, label: columnTitle(mapped, name) }))} onChange={setColumn} />
        <span>{column === "outcome" ? "opacity: odds of that outcome" : "opacity: odds of being caged"}</span>
      </div>
      <p className={own.reading}>{readingOf(atlas, shown, shown === null ? undefined : cells.get(shown))}</p>
      <div className={styles.picture} onPointerLeave={() => { setPointed(null); }}>
        <div className={styles.holder} ref={holder}>
          <StudyMap
            study={mapped}
            rows={rows}
            spread={spreadOf(atlas)}
            chosen={NONE_CHOSEN}
            column={column}
            published={null}
            paper={PAPERS[colorScheme === "light" ? "light" : "dark"]}
            frame={{ width: Math.max(width, 1), height: Math.max(height, 1) }}
            selected={selected}
            onSelect={onSelect}
            onPoint={setPointed}
            span={spanOf(rows, column)}
            sureness={sureness}
            detail={detailOf}
            mark={x === null || y === null ? null : { x, y, label: "The present point" }}
            caption={null}
          />
        </div>
      </div>
    </section>
  );
}

const NONE_CHOSEN: ReadonlyMap<string, number> = new Map();

const NO_ATLAS = {
  title: "What would other values do, from here?",
  words: "An atlas flies a few futures from the present state for every cell of a map over two parameters. It fills coarse first; a press on a cell stages its values.",
};

export function AtlasPage({ item, shown }: { readonly item: string; readonly shown: boolean }) {
  const view = useAtlas(shown ? item : "");
  const [selection, setSelection] = useState<{ readonly atlas: string; readonly number: number } | null>(null);
  const { stageValues } = useStaging();
  const { atlas, refusal } = view;
  const selected = selection?.atlas === item ? selection.number : null;
  const axes = atlas === null ? null : `${atlas.x.path} ${atlas.y.path}`;
  const select = useCallback(
    (number: number) => {
      if (atlas === null) return;
      const { x, y } = placeOf(atlas, number);
      setSelection({ atlas: atlas.id, number });
      stageValues({ [atlas.x.path]: atlas.x.values[x] ?? atlas.x.present, [atlas.y.path]: atlas.y.values[y] ?? atlas.y.present });
    },
    // An atlas keeps its axes while its cells come.
    // eslint-disable-next-line react-hooks/exhaustive-deps
    [atlas?.id, axes, stageValues],
  );
  return (
    <main className={styles.page} hidden={!shown}>
      <div className={styles.side}>
        <NewAtlas onStarted={(id) => { go("atlas", id); }} />
      </div>
      {atlas === null ? (
        <EmptyPage label="No atlas" title={refusal?.message ?? NO_ATLAS.title} words={refusal?.tip ?? NO_ATLAS.words} />
      ) : (
        <>
          <AtlasMap key={atlas.id} atlas={atlas} view={view} selected={selected} onSelect={select} />
          <div className={styles.side}>
            <CellPanel atlas={atlas} place={selected === null ? null : placeOf(atlas, selected)} cell={selected === null ? undefined : view.cells.get(selected)} />
          </div>
        </>
      )}
    </main>
  );
}

/** Studies: start one, watch its map fill, and open what stands in it. */
import { Progress } from "@mantine/core";
import { useCallback, useState } from "react";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { EmptyPage } from "../../ui/EmptyPage";
import { Panel } from "../../ui/Panel";
import { useKept } from "../../ui/use-kept";
import { go, hashOf } from "../../store/route";
import { useAction } from "../../api/use-action";
import { cancelStudy, deleteStudy, resumeStudy } from "../../api/service";
import type { StudyDetail, StudySummary } from "../../api/types";
import { fixed } from "../../units/units";
import { RoleButton } from "../access/RoleButton";
import { useReasonByRole } from "../access/session";
import { CellPanel } from "./CellPanel";
import { NewStudy } from "./NewStudy";
import styles from "./StudiesPage.module.css";
import { StudyResults } from "./StudyResults";
import { commonRange } from "./comparison";
import { rangeOf } from "./layout";
import { PairPanel } from "./PairPanel";
import { LOOKS, StudyView, usualColumn, type Look } from "./StudyView";
import { isUnderWay, useReadAgain, useStudies, useStudy, type Rows } from "./use-study";
import { span } from "./labels";

function progressWords({ status, progress, note }: StudySummary): string {
  const cells = `${progress.done} of ${progress.total} cells`;
  if (status === "queued") return `waiting, ${cells}`;
  if (status === "running") {
    const left = typeof progress.time_left === "number" ? `, ${span(progress.time_left)} left` : "";
    return `${cells}${left}`;
  }
  return `${status}, ${cells}${note === null ? "" : `: ${note}`}`;
}

/** @param open the study that is open @param other the one beside it */
function StudyItem({ study, open, other }: { readonly study: StudySummary; readonly open: string; readonly other: string }) {
  const [chosen, compared] = [study.id === open, study.id === other];
  return (
    <li className={styles.entry}>
      <a className={styles.item} href={`#/studies/${study.id}`} aria-current={chosen ? "true" : undefined} data-status={study.status}>
        <strong>{study.name}</strong>
        <span>{progressWords(study)}</span>
        <Progress size={3} value={(100 * study.progress.done) / Math.max(1, study.progress.total)} aria-label={`Progress of ${study.name}`} />
      </a>
      {open !== "" && !chosen && (
        <a className={styles.compare} href={hashOf({ page: "studies", item: open, other: compared ? "" : study.id })} aria-current={compared ? "true" : undefined} aria-label={`${compared ? "Compared" : "Compare"}: ${study.name}`}>
          {compared ? "Compared" : "Compare"}
        </a>
      )}
    </li>
  );
}

function StudyHead({ study, onChange }: { readonly study: StudyDetail; readonly onChange: () => Promise<void> }) {
  const { runAction: asked, refusal } = useAction();
  const deletingDisabledReason = useReasonByRole("admin");
  const runAction = (work: () => Promise<unknown>) => asked(() => work().then(onChange));
  const rate = study.progress.cells_per_second;
  const remove = async () => {
    await deleteStudy(study.id);
    go("studies");
  };
  return (
    <header className={styles.head}>
      <h2>{study.name}</h2>
      <span role="status">
        {progressWords(study)}
        {typeof rate === "number" && `, ${fixed(rate, 1)} per second`}
      </span>
      <span className={styles.spring} />
      {isUnderWay(study) && <RoleButton needs="operator" onClick={() => void runAction(() => cancelStudy(study.id))}>Cancel</RoleButton>}
      {(study.status === "cancelled" || study.status === "failed") && <RoleButton needs="operator" onClick={() => void runAction(() => resumeStudy(study.id))}>Resume</RoleButton>}
      {!isUnderWay(study) && <ConfirmButton label="Delete" question="Delete permanently?" disabledReason={deletingDisabledReason} onConfirm={() => void runAction(remove)} />}
      {study.notices.length > 0 && <p>{study.notices.join("; ")}</p>}
      {refusal && <p role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
    </header>
  );
}

const NO_STUDY = {
  title: "What would happen if …?",
  words:
    "A study runs many captures with varied parameters and maps their results. Start with the paper's 484 cells: their map fills beside the published one, and every cell opens as a run in the scene.",
};

/** The study beside the one that is open. */
function OtherHead({ study, open }: { readonly study: StudyDetail; readonly open: string }) {
  return (
    <header className={styles.head}>
      <h2>{study.name}</h2>
      <span role="status">{progressWords(study)}</span>
      <span className={styles.spring} />
      <a className={styles.compare} href={hashOf({ page: "studies", item: open })}>End comparison</a>
    </header>
  );
}

interface Shown {
  readonly study: StudyDetail;
  readonly rows: Rows;
}

/** One study, or two beside one another by one measure and one scale of colours. */
function Views({ one, other, cell, onSelect, onChange }: { readonly one: Shown; readonly other: Shown | null; readonly cell: number | null; readonly onSelect: (cell: number) => void; readonly onChange: () => Promise<void> }) {
  const [column, setColumn] = useState(usualColumn(one.study));
  const [look, setLook] = useKept<Look>("becalm-study-look", "map", LOOKS);
  const common = { column, onColumn: setColumn, look, onLook: setLook };
  const otherId = other?.study.id ?? "";
  const openOther = useCallback(() => { go("studies", otherId); }, [otherId]);
  const span = other === null ? null : commonRange([rangeOf(one.rows.values(), column), rangeOf(other.rows.values(), column)]);
  return (
    <div className={styles.views} data-pair={other !== null || undefined}>
      <StudyView {...one} {...common} span={span} selected={cell} onSelect={onSelect} head={<StudyHead study={one.study} onChange={onChange} />} />
      {other !== null && (
        <StudyView key={other.study.id} {...other} {...common} span={span} selected={null} onSelect={openOther} head={<OtherHead study={other.study} open={one.study.id} />} />
      )}
    </div>
  );
}

export function StudiesPage({ item, other, shown }: { readonly item: string; readonly other: string; readonly shown: boolean }) {
  const { studies, unreadable, refusal, read } = useStudies(shown);
  const view = useStudy(shown ? item : "");
  const beside = useStudy(shown && other !== item ? other : "");
  const [selection, setSelection] = useState<{ readonly study: string; readonly cell: number } | null>(null);
  const readAgain = useReadAgain();
  const study = view.study;
  const missing = item === "" ? null : view.refusal;
  const empty = item === "" || missing !== null ? NO_STUDY : { title: "Loading the study", words: "" };
  const cell = selection?.study === item ? selection.cell : null;
  // The same from drawing to drawing: the thousands of cells of a map are drawn again by what is new to them.
  const select = useCallback((chosen: number) => { setSelection({ study: item, cell: chosen }); }, [item]);
  return (
    <main className={styles.page} hidden={!shown}>
      <div className={styles.side}>
        <NewStudy onStarted={(id) => { void readAgain(); go("studies", id); }} />
        <Panel title="Studies" grow aside={<span className={styles.count}>{studies.length > 0 ? studies.length : ""}</span>}>
          {refusal && <p className={styles.hint}>{refusal.message}</p>}
          {read && studies.length === 0 && <p className={styles.hint}>No studies yet.</p>}
          <ul className={styles.list}>
            {studies.map((each) => (
              <StudyItem key={each.id} study={each} open={item} other={other} />
            ))}
          </ul>
          {unreadable.map((each) => (
            <p key={each.id} className={styles.unreadable}>{`${each.id} cannot be read: ${each.reason}`}</p>
          ))}
        </Panel>
      </div>
      {study === null ? (
        <EmptyPage
          label="No study selected"
          title={missing?.message ?? empty.title}
          words={missing?.tip ?? empty.words}
        />
      ) : (
        <>
          <Views key={study.id} one={{ study, rows: view.rows }} other={beside.study && { study: beside.study, rows: beside.rows }} cell={cell} onSelect={select} onChange={readAgain} />
          <div className={styles.side}>
            {beside.refusal !== null && <p className={styles.trouble} role="alert">{`${beside.refusal.message} ${beside.refusal.tip}`}</p>}
            {beside.study === null ? <StudyResults study={study} /> : <PairPanel one={{ study, rows: view.rows }} other={{ study: beside.study, rows: beside.rows }} />}
            <CellPanel study={study} row={cell === null ? undefined : view.rows.get(cell)} />
          </div>
        </>
      )}
    </main>
  );
}

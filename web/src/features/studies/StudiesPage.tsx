/** Studies: start one, watch its map fill, and open what stands in it. */
import { Progress } from "@mantine/core";
import { useState } from "react";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { EmptyPage } from "../../ui/EmptyPage";
import { Panel } from "../../ui/Panel";
import { go } from "../../store/route";
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
import { StudyView } from "./StudyView";
import { isUnderWay, useReadAgain, useStudies, useStudy } from "./use-study";
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

function StudyItem({ study, chosen }: { readonly study: StudySummary; readonly chosen: boolean }) {
  return (
    <li>
      <a className={styles.item} href={`#/studies/${study.id}`} aria-current={chosen ? "true" : undefined} data-status={study.status}>
        <strong>{study.name}</strong>
        <span>{progressWords(study)}</span>
        <Progress size={3} value={(100 * study.progress.done) / Math.max(1, study.progress.total)} aria-label={`Progress of ${study.name}`} />
      </a>
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

export function StudiesPage({ item, shown }: { readonly item: string; readonly shown: boolean }) {
  const { studies, unreadable, refusal, read } = useStudies(shown);
  const view = useStudy(shown ? item : "");
  const [selection, setSelection] = useState<{ readonly study: string; readonly cell: number } | null>(null);
  const readAgain = useReadAgain();
  const study = view.study;
  const missing = item === "" ? null : view.refusal;
  const empty = item === "" || missing !== null ? NO_STUDY : { title: "Loading the study", words: "" };
  const cell = selection?.study === item ? selection.cell : null;
  return (
    <main className={styles.page} hidden={!shown}>
      <div className={styles.side}>
        <NewStudy onStarted={(id) => { void readAgain(); go("studies", id); }} />
        <Panel title="Studies" grow aside={<span className={styles.count}>{studies.length > 0 ? studies.length : ""}</span>}>
          {refusal && <p className={styles.hint}>{refusal.message}</p>}
          {read && studies.length === 0 && <p className={styles.hint}>No studies yet.</p>}
          <ul className={styles.list}>
            {studies.map((each) => (
              <StudyItem key={each.id} study={each} chosen={each.id === item} />
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
          <StudyView key={study.id} study={study} rows={view.rows} selected={cell} onSelect={(chosen) => { setSelection({ study: item, cell: chosen }); }} head={<StudyHead study={study} onChange={readAgain} />} />
          <div className={styles.side}>
            <StudyResults study={study} />
            <CellPanel study={study} row={cell === null ? undefined : view.rows.get(cell)} />
          </div>
        </>
      )}
    </main>
  );
}

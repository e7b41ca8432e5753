/** The form that starts a study: the paper's, or one's own. */
import { Button, Checkbox, TextInput } from "@mantine/core";
import { useState } from "react";
import { Panel } from "../../ui/Panel";
import { Refusal } from "../../api/refusal";
import { startStudy } from "../../api/service";
import type { StudyEstimate, StudyRequest } from "../../api/types";
import { useConfiguration, useNamedConfigurations } from "../../store/configuration";
import { Icon } from "../../ui/theme/Icon";
import { Choice } from "../../ui/Choice";
import type { ChoiceOption } from "../../ui/options";
import { useKeptJson } from "../../ui/use-kept-json";
import { SuggestInput } from "../../ui/SuggestInput";
import { useReasonByRole } from "../access/session";
import { readDraft, readKeptDraft, type DraftRead, type StudyDraft } from "./definition";
import styles from "./StudiesPage.module.css";
import { useEstimate } from "./use-estimate";
import { estimateWords, valuesWords } from "./labels";

const PUBLISHED: StudyRequest = { study: "published", changes: {}, confirm: false };

/** Of what can vary: a column of a study's table holds no list. */
function usePaths(): ChoiceOption[] {
  const { parameters } = useConfiguration();
  return parameters.filter(({ type }) => type !== "points").map(({ path, description, unit }) => ({ value: path, label: `${description} [${unit}]` }));
}

/** The named configurations of the service; while it has not listed them, the one that is chosen. */
function useConfigurations(chosen: string): readonly string[] {
  const names = useNamedConfigurations().map(({ name }) => name);
  return names.includes(chosen) ? names : [chosen, ...names];
}

interface LinesProps<Line> {
  readonly title: string;
  readonly kind: "grid" | "draws";
  readonly hint: string;
  readonly lines: readonly Line[];
  readonly fields: readonly [keyof Line & string, string][];
  readonly paths: readonly ChoiceOption[];
  readonly fresh: Line;
  readonly onChange: (lines: readonly Line[]) => void;
  readonly read: DraftRead;
  readonly estimate: StudyEstimate | null;
}

function Lines<Line extends { readonly path: string }>({ title, kind, hint, lines, fields, paths, fresh, onChange, read, estimate }: LinesProps<Line>) {
  return (
    <fieldset className={styles.lines}>
      <legend>{title}</legend>
      {lines.map((line, place) => {
        const fault = read.faults.get(`${kind} ${place}`);
        const axis = estimate?.axes.find(({ path }) => path === line.path.trim());
        return (
          <div key={place} className={styles.line}>
            {fields.map(([field, label]) => (
              <SuggestInput
                key={field}
                aria-label={`${title}, ${label} ${place + 1}`}
                placeholder={label}
                data={field === "path" ? paths : []}
                value={String(line[field])}
                error={fault !== undefined && field !== "path"}
                onChange={(value) => {
                  onChange(lines.map((each, at) => (at === place ? { ...each, [field]: value } : each)));
                }}
              />
            ))}
            <Button aria-label={`Remove line ${place + 1} of ${title}`} onClick={() => { onChange(lines.filter((_, at) => at !== place)); }}>
              <Icon icon="cross" size={10} />
            </Button>
            {fault !== undefined ? <p className={styles.fault}>{fault}</p> : axis?.values && <p className={styles.understood}>{valuesWords(axis)}</p>}
          </div>
        );
      })}
      <div className={styles.more}>
        <span>{hint}</span>
        <Button onClick={() => { onChange([...lines, fresh]); }}>Add</Button>
      </div>
    </fieldset>
  );
}

const METHODS = [
  { value: "latin_hypercube", label: "Latin hypercube" },
  { value: "sobol", label: "Sobol (a power of two)" },
  { value: "random", label: "Independent" },
];

interface FormProps {
  readonly draft: StudyDraft;
  readonly change: (part: Partial<StudyDraft>) => void;
  readonly read: DraftRead;
  readonly estimate: StudyEstimate | null;
}

function Form({ draft, change, read, estimate }: FormProps) {
  const paths = usePaths();
  const configurations = useConfigurations(draft.configuration);
  return (
    <>
      <TextInput label="Name" placeholder="study" maxLength={200} value={draft.name} onChange={(event) => { change({ name: event.currentTarget.value }); }} />
      <Choice label="Configuration" value={draft.configuration} data={configurations} onChange={(configuration) => { change({ configuration }); }} />
      <Lines title="Grid" kind="grid" hint="0.1, 0.2 or 0 .. 6 by 1.5 or 0 .. 6 in 5" lines={draft.grid} fields={[["path", "parameter"], ["values", "values"]]} paths={paths} fresh={{ path: "", values: "" }} onChange={(grid) => { change({ grid }); }} read={read} estimate={estimate} />
      <Lines title="Draws" kind="draws" hint="0.5 .. 1.5 or 2.35 ± 0.1" lines={draft.draws} fields={[["path", "parameter"], ["distribution", "distribution"]]} paths={paths} fresh={{ path: "", distribution: "" }} onChange={(draws) => { change({ draws }); }} read={read} estimate={estimate} />
      {draft.draws.length > 0 && (
        <div className={styles.pair}>
          <TextInput label="Number of draws" value={draft.count} error={read.faults.get("count")} onChange={(event) => { change({ count: event.currentTarget.value }); }} />
          <Choice label="Sampling method" value={draft.method} data={METHODS} onChange={(method) => { change({ method }); }} />
        </div>
      )}
      <div className={styles.pair}>
        <TextInput label="Seed" value={draft.seed} error={read.faults.get("seed")} onChange={(event) => { change({ seed: event.currentTarget.value }); }} />
        <Checkbox size="xs" label="Direct caging" checked={draft.direct} onChange={(event) => { change({ direct: event.currentTarget.checked }); }} />
      </div>
    </>
  );
}

/** What would be started, how long it takes, and the button that starts it. */
function Start({ request, faults, estimate, refusal, onStarted }: {
  readonly request: StudyRequest | null;
  readonly faults: number;
  readonly estimate: StudyEstimate | null;
  readonly refusal: Refusal | null;
  readonly onStarted: (id: string) => void;
}) {
  const [busy, setBusy] = useState(false);
  const [refused, setRefused] = useState<{ readonly by: Refusal; readonly request: StudyRequest } | null>(null);
  const disabledReason = useReasonByRole("operator");
  const start = async (wanted: StudyRequest): Promise<void> => {
    setBusy(true);
    setRefused(null);
    try {
      onStarted((await startStudy(wanted)).id);
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      setRefused({ by: cause, request: wanted });
    } finally {
      setBusy(false);
    }
  };
  const trouble = (refused?.request.study === request?.study ? refused?.by : null) ?? refusal;
  const words = request === null ? `${faults === 1 ? "One thing" : `${faults} things`} to correct first.` : estimate === null ? "Estimating how long it takes." : estimateWords(estimate);
  return (
    <>
      {trouble === null && <p className={styles.estimate} role="status">{words}</p>}
      {trouble && (
        <div className={styles.trouble} role="alert">
          <Icon icon="error" /> <strong>{trouble.message}</strong> <span>{trouble.tip}</span>
        </div>
      )}
      <Button variant="filled" disabled={busy || request === null || disabledReason !== null} title={disabledReason ?? undefined} onClick={() => { if (request !== null) void start({ ...request, confirm: estimate?.confirmation_needed ?? false }); }}>
        {busy ? "Starting" : estimate?.confirmation_needed ? "Start anyway" : "Start"}
      </Button>
    </>
  );
}

export function NewStudy({ onStarted }: { readonly onStarted: (id: string) => void }) {
  const [draft, setDraft] = useKeptJson("becalm-study-draft", readKeptDraft, "tab");
  const [open, setOpen] = useState<"published" | "own" | null>(null);
  const own = readDraft(draft);
  const request = open === "published" ? PUBLISHED : open === "own" ? own.request : null;
  const { estimate, refusal } = useEstimate(request);
  const toggle = (which: "published" | "own") => () => { setOpen(open === which ? null : which); };
  return (
    <Panel title="New study">
      <div className={styles.form}>
        <Button variant={open === null ? "filled" : "default"} aria-expanded={open === "published"} onClick={toggle("published")}>
          The paper&apos;s 484 cells
        </Button>
        <Button aria-expanded={open === "own"} onClick={toggle("own")}>
          Custom study
        </Button>
        {open === "own" && <Form draft={draft} change={(part) => { setDraft({ ...draft, ...part }); }} read={own} estimate={estimate} />}
        {open !== null && <Start request={request} faults={own.faults.size} estimate={estimate} refusal={refusal} onStarted={(id) => { setOpen(null); onStarted(id); }} />}
      </div>
    </Panel>
  );
}

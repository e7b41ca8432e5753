/** The form that starts a study: the paper's, or one's own. */
import { Button, Checkbox, NativeSelect, TextInput } from "@mantine/core";
import { useId, useState } from "react";
import { Panel } from "../../app/Panel";
import { Refusal } from "../../api/refusal";
import { startStudy } from "../../api/service";
import type { StudyRequest } from "../../api/types";
import { useConfiguration } from "../../store/configuration";
import { Icon } from "../../theme/Icon";
import { DraftError, EMPTY_DRAFT, requestOf, type StudyDraft } from "./definition";
import styles from "./StudiesPage.module.css";

interface Trouble {
  readonly words: string;
  readonly tip: string;
  /** Set where the service only wants to know whether so large a study is meant. */
  readonly confirm: boolean;
}

const troubleOf = (cause: unknown): Trouble => {
  if (cause instanceof Refusal) return { words: cause.message, tip: cause.tip, confirm: cause.tip.includes('"confirm"') };
  if (cause instanceof DraftError) return { words: cause.message, tip: "", confirm: false };
  throw cause;
};

function Paths({ id }: { readonly id: string }) {
  const { parameters } = useConfiguration();
  return (
    <datalist id={id}>
      {parameters.map((parameter) => (
        <option key={parameter.path} value={parameter.path}>{`${parameter.description} [${parameter.unit}]`}</option>
      ))}
    </datalist>
  );
}

interface LinesProps<Line> {
  readonly title: string;
  readonly hint: string;
  readonly lines: readonly Line[];
  readonly fields: readonly [keyof Line & string, string][];
  readonly paths: string;
  readonly fresh: Line;
  readonly onChange: (lines: readonly Line[]) => void;
}

function Lines<Line extends { readonly path: string }>({ title, hint, lines, fields, paths, fresh, onChange }: LinesProps<Line>) {
  return (
    <fieldset className={styles.lines}>
      <legend>{title}</legend>
      {lines.map((line, place) => (
        <div key={place} className={styles.line}>
          {fields.map(([field, label]) => (
            <TextInput
              key={field}
              aria-label={`${title}, ${label} ${place + 1}`}
              placeholder={label}
              list={field === "path" ? paths : undefined}
              value={String(line[field])}
              onChange={(event) => {
                const value = event.currentTarget.value;
                onChange(lines.map((each, at) => (at === place ? { ...each, [field]: value } : each)));
              }}
            />
          ))}
          <Button aria-label={`Remove line ${place + 1} of ${title}`} onClick={() => { onChange(lines.filter((_, at) => at !== place)); }}>
            <Icon sign="cross" size={10} />
          </Button>
        </div>
      ))}
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

function Form({ draft, change }: { readonly draft: StudyDraft; readonly change: (part: Partial<StudyDraft>) => void }) {
  const paths = useId();
  return (
    <>
      <Paths id={paths} />
      <TextInput label="Name" placeholder="study" value={draft.name} onChange={(event) => { change({ name: event.currentTarget.value }); }} />
      <NativeSelect label="Configuration" value={draft.configuration} data={["published", "published_figures", "as_printed"]} onChange={(event) => { change({ configuration: event.currentTarget.value }); }} />
      <Lines title="Grid" hint="0.1, 0.2 or 0 .. 6 by 1.5 or 0 .. 6 in 5" lines={draft.grid} fields={[["path", "parameter"], ["values", "values"]]} paths={paths} fresh={{ path: "", values: "" }} onChange={(grid) => { change({ grid }); }} />
      <Lines title="Draws" hint="0.5 .. 1.5 or 2.35 ± 0.1" lines={draft.draws} fields={[["path", "parameter"], ["distribution", "distribution"]]} paths={paths} fresh={{ path: "", distribution: "" }} onChange={(draws) => { change({ draws }); }} />
      {draft.draws.length > 0 && (
        <div className={styles.pair}>
          <TextInput label="Draws of each" value={draft.count} onChange={(event) => { change({ count: event.currentTarget.value }); }} />
          <NativeSelect label="Spread" value={draft.method} data={METHODS} onChange={(event) => { change({ method: event.currentTarget.value }); }} />
        </div>
      )}
      <div className={styles.pair}>
        <TextInput label="Seed" value={draft.seed} onChange={(event) => { change({ seed: event.currentTarget.value }); }} />
        <Checkbox size="xs" label="Direct caging" checked={draft.direct} onChange={(event) => { change({ direct: event.currentTarget.checked }); }} />
      </div>
    </>
  );
}

export function NewStudy({ onStarted }: { readonly onStarted: (id: string) => void }) {
  const [draft, setDraft] = useState(EMPTY_DRAFT);
  const [own, setOwn] = useState(false);
  const [busy, setBusy] = useState(false);
  const [trouble, setTrouble] = useState<Trouble | null>(null);

  const start = async (request: () => StudyRequest): Promise<void> => {
    setBusy(true);
    setTrouble(null);
    try {
      onStarted((await startStudy(request())).id);
    } catch (cause) {
      setTrouble(troubleOf(cause));
    } finally {
      setBusy(false);
    }
  };

  return (
    <Panel title="New study">
      <div className={styles.form}>
        <Button variant="filled" disabled={busy} onClick={() => void start(() => ({ study: "published", changes: {}, confirm: false }))}>
          The paper&apos;s 484 cells
        </Button>
        <Button aria-expanded={own} onClick={() => { setOwn(!own); }}>
          A study of my own
        </Button>
        {own && (
          <>
            <Form draft={draft} change={(part) => { setDraft({ ...draft, ...part }); }} />
            <Button variant="filled" disabled={busy} onClick={() => void start(() => requestOf(draft, false))}>
              {busy ? "Asking the service" : "Start"}
            </Button>
          </>
        )}
        {trouble && (
          <div className={styles.trouble} role="alert">
            <Icon sign="error" /> <strong>{trouble.words}</strong>
            {trouble.confirm ? (
              <Button disabled={busy} onClick={() => void start(() => requestOf(draft, true))}>
                Start it all the same
              </Button>
            ) : (
              <span>{trouble.tip}</span>
            )}
          </div>
        )}
      </div>
    </Panel>
  );
}

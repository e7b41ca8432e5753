/** The form of parameters, drawn from the schema: edits are staged, compared, applied together or discarded. */
import { Button, TextInput } from "@mantine/core";
import { Fragment, useEffect, useState, type ReactNode } from "react";
import { Panel } from "../../ui/Panel";
import { usePreferences } from "../../units/preferences";
import { Refusal } from "../../api/refusal";
import { changeConfiguration, readConfiguration } from "../../api/service";
import type { MissionConfiguration, Parameter, Preset, PresetBody } from "../../api/types";
import { methodWords } from "../../source/methods";
import { useConfiguration, type Configuration } from "../../store/configuration";
import { Icon } from "../../ui/theme/Icon";
import { useArmingOf } from "./arming";
import { draftTowards, found, meaning, nested, patchOf, settled, undoOf, valueAt, valueOf, type Change, type Draft } from "./draft";
import { onFindParameter } from "./find";
import { groupsOf } from "./groups";
import { ParameterField } from "./ParameterField";
import styles from "./ParameterPanel.module.css";
import { Presets } from "./Presets";
import { StagedChanges, UndoLine } from "./StagedChanges";
import { useStaging } from "./staging";

/** The parameter that names the method. */
const METHOD = "method";

interface Editing {
  readonly draft: Draft;
  readonly refusals: Readonly<Record<string, string>>;
  readonly edit: (parameter: Parameter, text: string) => void;
  readonly leave: (parameter: Parameter) => void;
}

function useFields({ parameters, inForce }: Configuration, { draft, refusals, edit, leave }: Editing) {
  const { angles } = usePreferences();
  return (parameter: Parameter) => {
    const value = valueAt(inForce?.config, parameter.path);
    if (value === undefined || parameters.length === 0) return null;
    const entry = draft[parameter.path];
    const typed = entry && meaning(parameter, entry.text, entry.angles);
    const error = typed && "error" in typed ? typed.error : refusals[parameter.path];
    return (
      <ParameterField
        key={parameter.path}
        parameter={parameter}
        value={value}
        staged={entry?.text}
        error={error}
        named={valueOf(inForce?.edited[parameter.path]?.from)}
        angles={entry?.angles ?? angles}
        edit={edit}
        leave={leave}
      />
    );
  };
}

/** The refusal's findings by field, also of a part of one; one that names no field of the form belongs to all. */
function findings(refusal: Refusal, parameters: readonly Parameter[]): Record<string, string> {
  const owner = (field: string): string => parameters.find(({ path }) => field.startsWith(`${path}.`))?.path ?? field;
  const named = refusal.fields.map(({ field, message }): [string, string] => [owner(field), message]);
  if (named.length > 0) return Object.fromEntries(named);
  const guilty = parameters.find((parameter) => refusal.message.includes(parameter.path));
  return guilty ? { [guilty.path]: refusal.message } : {};
}

/** What is in force with what is staged, as a named configuration and its changes. */
function presentOf(inForce: MissionConfiguration, changes: readonly Change[]): PresetBody {
  const edited = Object.entries(inForce.edited).map(([path, { to }]): [string, unknown] => [path, to]);
  const staged = changes.map(({ parameter, to }): [string, unknown] => [parameter.path, to]);
  return { configuration: inForce.name.replace(" (edited)", ""), changes: nested([...edited, ...staged]) };
}

interface FindProps {
  readonly query: string;
  readonly setQuery: (query: string) => void;
  /** How many are staged or differ from the named configuration. */
  readonly edited: number;
  readonly only: boolean;
  readonly setOnly: (only: boolean) => void;
}

function Find({ query, setQuery, edited, only, setOnly }: FindProps) {
  return (
    <div className={styles.find}>
      <TextInput
        aria-label="Search parameters"
        placeholder="Search all parameters"
        type="search"
        leftSection={<Icon icon="search" />}
        value={query}
        onChange={(event) => {
          setQuery(event.currentTarget.value);
        }}
      />
      <Button aria-pressed={only} variant={only ? "filled" : "default"} title="Show only parameters that are staged or differ from the named configuration" onClick={() => { setOnly(!only); }}>
        {`Edited ${edited}`}
      </Button>
    </div>
  );
}

/** The draft, and what may be done with it. */
function useDraft({ parameters, inForce, setInForce }: Configuration) {
  const { angles } = usePreferences();
  const { draft, setDraft, changes } = useStaging();
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const [applying, setApplying] = useState(false);
  const [applied, setApplied] = useState<readonly Change[]>([]);
  const arming = useArmingOf(changes);
  const attempt = async (work: () => Promise<void>): Promise<void> => {
    setRefusal(null);
    try {
      await work();
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      setRefusal(cause);
    }
  };
  const edit = (parameter: Parameter, text: string): void => {
    const unit = draft[parameter.path]?.angles ?? angles;
    setDraft({ ...draft, [parameter.path]: { text, angles: unit } });
    setRefusal(null);
  };
  const leave = (parameter: Parameter): void => {
    setDraft((old) => settled(old, parameter, inForce?.config));
  };
  const discard = (): void => {
    setDraft({});
    setRefusal(null);
  };
  /** Beside what is in force now, which a reset a moment ago may have changed. */
  const stage = ({ config }: Preset): Promise<void> =>
    attempt(async () => {
      const now = await readConfiguration();
      setInForce(now);
      setDraft(draftTowards(config, parameters, now.config, angles));
    });
  const apply = async (): Promise<void> => {
    setApplying(true);
    await attempt(async () => {
      if (await arming.comesFirst()) return;
      setInForce(await changeConfiguration(patchOf(changes), arming.armed?.arming.token ?? null));
      // What takes a new mission cannot be taken back without one.
      setApplied(changes.every(({ parameter }) => parameter.live) ? changes : []);
      discard();
    }).finally(() => {
      setApplying(false);
    });
  };
  const back = undoOf(applied, inForce?.config);
  const undo = (): Promise<void> =>
    attempt(async () => {
      setInForce(await changeConfiguration(patchOf(back)));
      setApplied([]);
    });
  return { draft, changes, refusal, applying, armed: arming.armed, edit, leave, discard, stage, apply, back, undo };
}

/** @param beside what else may be done with staged changes, beside discarding and applying them */
export function ParameterPanel({ beside }: { readonly beside?: ReactNode }) {
  const configuration = useConfiguration();
  const { parameters, inForce } = configuration;
  const { draft, changes, refusal, applying, armed, edit, leave, discard, stage, apply, back, undo } = useDraft(configuration);
  const { unsound } = useStaging();
  const [query, setQuery] = useState("");
  const [onlyEdited, setOnlyEdited] = useState(false);
  useEffect(
    () =>
      onFindParameter((path) => {
        setQuery(path);
        setOnlyEdited(false);
      }),
    [],
  );
  const present = inForce === null ? null : presentOf(inForce, changes);
  const refusals = refusal === null ? {} : findings(refusal, parameters);
  const field = useFields(configuration, { draft, refusals, edit, leave });
  const isEdited = ({ path }: Parameter): boolean => path in draft || inForce?.edited[path] !== undefined;
  const edited = parameters.filter(isEdited).length;
  const matching = found(parameters, query).filter((parameter) => !onlyEdited || isEdited(parameter));
  const searching = query !== "" || onlyEdited;
  const methods = parameters.find(({ path }) => path === METHOD)?.choices ?? [];
  const configured = draft[METHOD]?.text ?? String(valueAt(inForce?.config, METHOD) ?? "");
  return (
    <Panel title="Parameters" grow tall aside={<span className={styles.count}>{parameters.length > 0 && `${matching.length} of ${parameters.length}`}</span>}>
      <Find query={query} setQuery={setQuery} edited={edited} only={onlyEdited} setOnly={setOnlyEdited} />
      <div className={styles.groups} tabIndex={-1}>
        {searching && matching.length === 0 && <p className={styles.none}>{query === "" ? "No edited parameters." : "No matching parameters."}</p>}
        {groupsOf(matching, methods, configured).map(({ group, title, members, idleMethod, begins }, place) => (
          <Fragment key={`${group} ${searching}`}>
            {begins && <h3 className={styles.idle}>{`Only by the method ${methodWords(idleMethod ?? configured)}`}</h3>}
            <details className={styles.group} open={searching || place === 0}>
              <summary>
                {title} <span>{members.length}</span>
              </summary>
              {members.map(field)}
            </details>
          </Fragment>
        ))}
        {!searching && <Presets present={present} stage={(preset) => void stage(preset)} />}
      </div>
      {Object.keys(draft).length === 0 && back.length > 0 && <UndoLine back={back} refusal={refusal} undo={() => void undo()} />}
      <StagedChanges
        changes={changes}
        unsound={unsound}
        beside={beside}
        touched={Object.keys(draft).length > 0}
        refusal={refusal}
        applying={applying}
        armed={armed}
        apply={() => void apply()}
        discard={discard}
      />
    </Panel>
  );
}

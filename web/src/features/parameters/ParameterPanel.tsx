/** The form of parameters, drawn from the schema: edits are staged, compared, applied together or discarded. */
import { TextInput } from "@mantine/core";
import { useState } from "react";
import { Panel } from "../../app/Panel";
import { usePreferences } from "../../app/preferences";
import { Refusal } from "../../api/refusal";
import { changeConfiguration, readConfiguration } from "../../api/service";
import type { MissionConfiguration, Parameter, Preset, PresetBody } from "../../api/types";
import { useConfiguration, type Configuration } from "../../store/configuration";
import { Icon } from "../../theme/Icon";
import { useArmingOf } from "./arming";
import { changesOf, draftTowards, found, meaning, nested, patchOf, settled, unsoundFields, valueAt, words, type Change, type Draft } from "./draft";
import { ParameterField } from "./ParameterField";
import styles from "./ParameterPanel.module.css";
import { Presets } from "./Presets";
import { StagedChanges } from "./StagedChanges";

/** What the console is for: the impedance stands first and open. */
const FIRST_GROUP = "control.impedance";

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
        angles={entry?.angles ?? angles}
        edit={edit}
        leave={leave}
      />
    );
  };
}

function groupsOf(parameters: readonly Parameter[]): [string, Parameter[]][] {
  const groups = new Map<string, Parameter[]>();
  for (const parameter of parameters) {
    const group = groups.get(parameter.group);
    if (group) group.push(parameter);
    else groups.set(parameter.group, [parameter]);
  }
  // Those that may change while the mission flies come first; the sort keeps the service's order otherwise.
  const fixed = (members: readonly Parameter[]): number => (members.some((parameter) => parameter.live) ? 0 : 1);
  return [...groups].sort(([, one], [, other]) => fixed(one) - fixed(other));
}

/** `control.touch` as a heading; the service decides what the groups are. */
const heading = (group: string): string => group.split(".").map(words).join(" · ");

/** The refusal's findings by field; one that names no field of the form belongs to all. */
function findings(refusal: Refusal, parameters: readonly Parameter[]): Record<string, string> {
  const named = refusal.fields.map(({ field, message }): [string, string] => [field, message]);
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

export function ParameterPanel() {
  const configuration = useConfiguration();
  const { parameters, inForce, setInForce } = configuration;
  const { angles } = usePreferences();
  const [draft, setDraft] = useState<Draft>({});
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const [applying, setApplying] = useState(false);
  const [query, setQuery] = useState("");

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
  const changes = changesOf(draft, parameters, inForce?.config);
  /** Against what is in force now, which a reset a moment ago may have changed. */
  const stage = async ({ config }: Preset): Promise<void> => {
    try {
      const now = await readConfiguration();
      setInForce(now);
      setDraft(draftTowards(config, parameters, now.config, angles));
      setRefusal(null);
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      setRefusal(cause);
    }
  };
  const arming = useArmingOf(changes);
  const apply = async (): Promise<void> => {
    setApplying(true);
    setRefusal(null);
    try {
      if (await arming.comesFirst()) return;
      setInForce(await changeConfiguration(patchOf(changes), arming.armed?.arming.token ?? null));
      discard();
    } catch (cause) {
      if (!(cause instanceof Refusal)) throw cause;
      setRefusal(cause);
    } finally {
      setApplying(false);
    }
  };

  const present = inForce === null ? null : presentOf(inForce, changes);
  const refusals = refusal === null ? {} : findings(refusal, parameters);
  const field = useFields(configuration, { draft, refusals, edit, leave });
  const matching = found(parameters, query);
  return (
    <Panel title="Parameters" grow aside={<span className={styles.count}>{parameters.length > 0 && `${matching.length} of ${parameters.length}`}</span>}>
      <div className={styles.first}>{parameters.filter((parameter) => parameter.group === FIRST_GROUP).map(field)}</div>
      <Presets present={present} stage={(preset) => void stage(preset)} />
      <TextInput
        className={styles.search}
        aria-label="Search parameters"
        placeholder="Search all parameters"
        type="search"
        leftSection={<Icon sign="search" />}
        value={query}
        onChange={(event) => {
          setQuery(event.currentTarget.value);
        }}
      />
      <div className={styles.groups} tabIndex={-1}>
        {groupsOf(matching.filter((parameter) => parameter.group !== FIRST_GROUP)).map(([group, members]) => (
          <details key={`${group} ${query === ""}`} className={styles.group} open={query !== ""}>
            <summary>
              {heading(group)} <span>{members.length}</span>
            </summary>
            {members.map(field)}
          </details>
        ))}
      </div>
      <StagedChanges
        changes={changes}
        unsound={unsoundFields(draft, parameters).length}
        touched={Object.keys(draft).length > 0}
        refusal={refusal}
        applying={applying}
        armed={arming.armed}
        apply={() => void apply()}
        discard={discard}
      />
    </Panel>
  );
}

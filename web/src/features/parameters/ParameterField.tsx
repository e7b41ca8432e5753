/** One parameter: its value, what is staged, and everything known about it on hover or focus. */
import { ActionIcon, Textarea, TextInput, Tooltip } from "@mantine/core";
import { Fragment, useId, type ChangeEvent, type KeyboardEvent } from "react";
import type { Parameter } from "../../api/types";
import { Icon } from "../../ui/theme/Icon";
import { Choice } from "../../ui/Choice";
import { shown, type AngleUnit } from "../../units/units";
import { boundsText, fieldText, nudged, words, type Value } from "./draft";
import styles from "./ParameterField.module.css";

export interface FieldState {
  readonly parameter: Parameter;
  /** In force. */
  readonly value: Value;
  /** What stands in the field if it was edited. */
  readonly staged: string | undefined;
  readonly error: string | undefined;
  /** Its value in the named configuration, if what is in force differs from it. */
  readonly named: Value | undefined;
  readonly angles: AngleUnit;
  readonly edit: (parameter: Parameter, text: string) => void;
  /** The field has been left. */
  readonly leave: (parameter: Parameter) => void;
}

function About({ parameter, value, angles }: FieldState) {
  const { unit } = shown(parameter.unit, angles);
  const standard = parameter.default;
  return (
    <div className={styles.about}>
      <strong>{parameter.description}</strong>
      <dl>
        <dt>In force</dt>
        <dd>{`${fieldText(parameter, value, angles)} ${unit}`}</dd>
        <dt>Default</dt>
        <dd>{`${fieldText(parameter, standard, angles)} ${unit}`}</dd>
        {!parameter.choices && <dt>Bounds</dt>}
        {!parameter.choices && <dd>{boundsText(parameter, angles)}</dd>}
        {Object.entries(parameter.choice_titles).map(([choice, title]) => (
          <Fragment key={choice}>
            <dt>{words(choice)}</dt>
            <dd>{title}</dd>
          </Fragment>
        ))}
        <dt>Source</dt>
        <dd>{parameter.source}</dd>
        <dt>Takes effect</dt>
        <dd>{parameter.live ? "during a mission" : "at the start of a mission; requires a reset"}</dd>
      </dl>
      <code>{parameter.path}</code>
    </div>
  );
}

interface EntryProps extends FieldState {
  readonly id: string;
  readonly note: string;
}

function Entry(state: EntryProps) {
  const { parameter, edit } = state;
  if (parameter.choices) {
    return (
      <Choice
        {...commonOf(state)}
        className={styles.entry}
        title={parameter.choice_titles[state.staged ?? String(state.value)]}
        data={parameter.choices.map((choice) => ({ value: choice, label: words(choice) }))}
        onChange={(choice) => {
          edit(parameter, choice);
        }}
      />
    );
  }
  return parameter.type === "points" ? <PointsEntry {...state} /> : <NumberEntry {...state} />;
}

const commonOf = ({ parameter, value, staged, error, angles, id, note }: EntryProps) => ({
  id,
  value: staged ?? fieldText(parameter, value, angles),
  error: error !== undefined,
  "aria-describedby": note,
});

/** What a typed entry has beside it and does, whether it is one number or many. */
const typedOf = (state: EntryProps) => ({
  ...commonOf(state),
  autoComplete: "off",
  rightSection: <span className={styles.unit}>{shown(state.parameter.unit, state.angles).unit}</span>,
  rightSectionPointerEvents: "none" as const,
  onBlur: () => {
    state.leave(state.parameter);
  },
  onChange: (event: ChangeEvent<HTMLInputElement | HTMLTextAreaElement>) => {
    state.edit(state.parameter, event.currentTarget.value);
  },
});

const PointsEntry = (state: EntryProps) => <Textarea {...typedOf(state)} className={styles.points} autosize minRows={2} />;

function NumberEntry(state: EntryProps) {
  const { parameter, edit } = state;
  const typed = typedOf(state);
  const arrows = (event: KeyboardEvent<HTMLInputElement>): void => {
    if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
    event.preventDefault();
    edit(parameter, nudged(typed.value, event.key === "ArrowUp" ? 1 : -1));
  };
  return (
    <TextInput
      {...typed}
      className={styles.entry}
      inputMode="decimal"
      rightSectionWidth={46}
      onKeyDown={arrows}
      onFocus={(event) => {
        event.currentTarget.select();
      }}
    />
  );
}

/** Back to what is in force, or to the default: staged like any edit. */
function Returns({ parameter, value, staged, named, angles, edit, leave }: FieldState) {
  const { unit } = shown(parameter.unit, angles);
  const inForce = fieldText(parameter, value, angles);
  const standard = fieldText(parameter, named ?? value, angles);
  const text = staged ?? inForce;
  return (
    <span className={styles.returns}>
      {staged !== undefined && text !== inForce && (
        <ActionIcon size={18} aria-label={`${parameter.title}: revert to the value in force`} title={`Revert to the value in force: ${inForce} ${unit}`} onClick={() => { edit(parameter, inForce); leave(parameter); }}>
          <Icon icon="cross" size={9} />
        </ActionIcon>
      )}
      {named !== undefined && text !== standard && (
        <ActionIcon size={18} aria-label={`${parameter.title}: revert to the named configuration`} title={`Revert to the named configuration: ${standard} ${unit}`} onClick={() => { edit(parameter, standard); }}>
          <Icon icon="reset" size={11} />
        </ActionIcon>
      )}
    </span>
  );
}

export function ParameterField(state: FieldState) {
  const { parameter, staged, error, named, angles } = state;
  const id = useId();
  const note = `${id}-note`;
  return (
    <Tooltip label={<About {...state} />} position="right" openDelay={400} events={{ hover: true, focus: false, touch: false }}>
      <div className={styles.field} data-staged={staged !== undefined || undefined} data-edited={named !== undefined || undefined}>
        <label className={styles.label} htmlFor={id}>
          <span>{parameter.title}</span>
          {named !== undefined && (
            <span className={styles.edited} title={`Edited; the named configuration has ${fieldText(parameter, named, angles)} ${shown(parameter.unit, angles).unit}`}>
              edited
            </span>
          )}
          {!parameter.live && (
            <span className={styles.reset} title="Requires reset">
              <Icon icon="lock" size={11} />
              <span className="visually-hidden">, requires a reset</span>
            </span>
          )}
        </label>
        <Entry {...state} id={id} note={note} />
        <Returns {...state} />
        <p id={note} className={error === undefined ? "visually-hidden" : styles.error}>
          {error ?? `${parameter.description}. Source: ${parameter.source}`}
        </p>
      </div>
    </Tooltip>
  );
}

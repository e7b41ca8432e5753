/** One of several, from a drop-down of our own: a native one keeps the first Esc to itself, and Esc stops the mission. */
import { Combobox, InputBase, useCombobox } from "@mantine/core";
import { useId, useState, type KeyboardEvent } from "react";
import { EscNote } from "./EscNote";
import { longestOf, optionsOf, typedTo, type ChoiceOption } from "./options";
import styles from "./ui.module.css";

interface ChoiceProps {
  /** Stands above it. Without one, `aria-label` names it. */
  readonly label?: string;
  readonly "aria-label"?: string;
  readonly "aria-describedby"?: string;
  readonly id?: string;
  readonly title?: string | undefined;
  readonly className?: string | undefined;
  readonly value: string;
  readonly data: readonly (string | ChoiceOption)[];
  readonly onChange: (value: string) => void;
  readonly onFocus?: () => void;
  readonly disabled?: boolean;
  readonly error?: boolean;
  /** Within a popup that closes when something outside of it is pressed. */
  readonly within?: boolean;
}

function Options({ options, value, id, label }: { readonly options: readonly ChoiceOption[]; readonly value: string; readonly id: string; readonly label: string }) {
  return (
    <Combobox.Dropdown className={styles.dropdown ?? ""}>
      <Combobox.Options className={styles.options ?? ""} aria-label={label}>
        {options.map((option, place) => (
          <Combobox.Option
            key={option.value}
            id={`${id}-${place}`}
            value={option.value}
            active={option.value === value}
            aria-selected={option.value === value}
            {...(option.disabled === true && { disabled: true })}
          >
            {option.label}
          </Combobox.Option>
        ))}
      </Combobox.Options>
      <EscNote />
    </Combobox.Dropdown>
  );
}

/** The state of a drop-down whose options are reached by typed letters, too. */
function useTypedCombobox(options: readonly ChoiceOption[], list: string) {
  // The option that a typed letter went to, until another key moves on.
  const [typed, setTyped] = useState<string | null>(null);
  const combobox = useCombobox({
    onDropdownOpen: () => {
      combobox.updateSelectedOptionIndex("active", { scrollIntoView: true });
    },
    onDropdownClose: () => {
      combobox.resetSelectedOption();
      setTyped(null);
    },
  });
  const onKeyDown = (event: KeyboardEvent): void => {
    setTyped(null);
    if (!combobox.dropdownOpened) return;
    const place = typedTo(event, options, combobox.getSelectedOptionIndex());
    if (place === null) return;
    event.preventDefault();
    combobox.selectOption(place);
    setTyped(`${list}-${place}`);
  };
  return { combobox, typed, onKeyDown };
}

export function Choice({ value, data, onChange, within = false, className, ...input }: ChoiceProps) {
  const options = optionsOf(data);
  const list = useId();
  const { combobox, typed, onKeyDown } = useTypedCombobox(options, list);
  const chosen = options.find((option) => option.value === value);
  return (
    <Combobox
      store={combobox}
      withinPortal={!within}
      width="max-content"
      position="bottom-start"
      onOptionSubmit={(next) => {
        onChange(next);
        combobox.closeDropdown();
      }}
    >
      <Combobox.Target targetType="button" withExpandedAttribute {...(typed !== null && { "aria-activedescendant": typed })}>
        <InputBase
          component="button"
          type="button"
          size="xs"
          miw={0}
          pointer
          className={className ?? ""}
          rightSection={<Combobox.Chevron />}
          rightSectionPointerEvents="none"
          onKeyDown={onKeyDown}
          onClick={() => {
            combobox.toggleDropdown();
          }}
          onBlur={() => {
            combobox.closeDropdown();
          }}
          {...input}
        >
          <span className={styles.chosen} data-longest={longestOf(options)}>{chosen?.label ?? value}</span>
        </InputBase>
      </Combobox.Target>
      <Options options={options} value={value} id={list} label={input["aria-label"] ?? input.label ?? "Choices"} />
    </Combobox>
  );
}

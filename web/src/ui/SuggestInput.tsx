/** A text field that suggests what may stand in it, in a list of our own (see Choice). */
import { Combobox, TextInput, useCombobox, type TextInputProps } from "@mantine/core";
import { EscNote } from "./EscNote";
import { suggestionsFor, type ChoiceOption } from "./options";
import styles from "./ui.module.css";

interface SuggestInputProps extends Omit<TextInputProps, "value" | "onChange" | "data"> {
  readonly value: string;
  readonly data: readonly ChoiceOption[];
  readonly onChange: (value: string) => void;
}

export function SuggestInput({ value, data, onChange, ...input }: SuggestInputProps) {
  const combobox = useCombobox({ onDropdownClose: () => { combobox.resetSelectedOption(); } });
  const suggestions = suggestionsFor(value, data);
  return (
    <Combobox
      store={combobox}
      width="max-content"
      position="bottom-start"
      onOptionSubmit={(next) => {
        onChange(next);
        combobox.closeDropdown();
      }}
    >
      <Combobox.Target withExpandedAttribute>
        <TextInput
          {...input}
          value={value}
          onChange={(event) => {
            onChange(event.currentTarget.value);
            combobox.openDropdown();
          }}
          onClick={() => { combobox.openDropdown(); }}
          onBlur={() => { combobox.closeDropdown(); }}
        />
      </Combobox.Target>
      <Combobox.Dropdown hidden={suggestions.length === 0} className={styles.dropdown ?? ""}>
        <Combobox.Options className={styles.options ?? ""} aria-label={input["aria-label"] ?? "Suggestions"}>
          {suggestions.map((option) => (
            <Combobox.Option key={option.value} value={option.value} aria-selected={option.value === value}>
              {option.value} <span className={styles.what}>{option.label}</span>
            </Combobox.Option>
          ))}
        </Combobox.Options>
        <EscNote />
      </Combobox.Dropdown>
    </Combobox>
  );
}

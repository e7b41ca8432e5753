/** What is not known for sure, and how unsure it is taken to be: a fold whose edits stay. */
import { TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useId } from "react";
import { readUncertainty } from "../../api/service";
import type { UncertaintyField } from "../../api/types";
import { useView } from "../../store/context";
import { plain, shown } from "../../units/units";
import { usePlan } from "./plan";
import styles from "./Rehearse.module.css";

const NONE: readonly UncertaintyField[] = [];

/** Read with each connection; none until the service has said. */
export function useUncertaintyFields(): readonly UncertaintyField[] {
  const connections = useView((view) => view.connections);
  return useQuery({ queryKey: ["uncertainty", connections], queryFn: readUncertainty, staleTime: Infinity }).data ?? NONE;
}

interface FieldProps {
  readonly label: string;
  readonly title: string;
  readonly unit: string;
  readonly value: string;
  readonly edited: boolean;
  readonly fault: string | undefined;
  readonly edit: (text: string) => void;
}

function Field({ label, title, unit, value, edited, fault, edit }: FieldProps) {
  const id = useId();
  return (
    <div className={styles.field} data-edited={edited || undefined} title={title}>
      <label htmlFor={id}>{label}</label>
      <TextInput
        id={id}
        inputMode="decimal"
        value={value}
        error={fault !== undefined}
        rightSectionWidth={46}
        rightSection={<span>{unit}</span>}
        aria-describedby={`${id}-note`}
        onChange={(event) => {
          edit(event.currentTarget.value);
        }}
      />
      <p id={`${id}-note`} className={fault === undefined ? "visually-hidden" : undefined}>
        {fault ?? title}
      </p>
    </div>
  );
}

const words = (name: string): string => name.charAt(0).toUpperCase() + name.slice(1).replaceAll("_", " ");

export function Uncertainty({ fields, faults }: { readonly fields: readonly UncertaintyField[]; readonly faults: ReadonlyMap<string, string> }) {
  const { plan, change } = usePlan();
  const edited = fields.filter(({ name }) => name in plan.uncertainty).length;
  const edit = (field: UncertaintyField, text: string): void => {
    const others = Object.entries(plan.uncertainty).filter(([name]) => name !== field.name);
    change({ uncertainty: Object.fromEntries(text === plain(field.default) ? others : [...others, [field.name, text]]) });
  };
  return (
    <details className={styles.fold}>
      <summary>
        Uncertainty <span>{edited === 0 ? "defaults" : `${edited} edited`}</span>
      </summary>
      <div className={styles.fields}>
        {fields.map((field) => (
          <Field
            key={field.name}
            label={words(field.name)}
            title={`${field.description}. Source: ${field.source}. Default ${plain(field.default)}, from ${plain(field.minimum)} to ${plain(field.maximum)}.`}
            unit={shown(field.unit, "rad").unit}
            value={plan.uncertainty[field.name] ?? plain(field.default)}
            edited={field.name in plan.uncertainty}
            fault={faults.get(field.name)}
            edit={(text) => {
              edit(field, text);
            }}
          />
        ))}
        <Field label="Seed" title="The same seed draws the same futures." unit="" value={plan.seed} edited={plan.seed !== "0"} fault={faults.get("seed")} edit={(seed) => { change({ seed }); }} />
      </div>
    </details>
  );
}

/** Parameters kept by name: chosen, they are staged like any edit; what is in force and staged is kept by a name. */
import { Button, TextInput } from "@mantine/core";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { useAction } from "../../api/use-action";
import { keepPreset, readPresets, removePreset } from "../../api/service";
import type { Preset, PresetBody } from "../../api/types";
import { useView } from "../../store/context";
import { Choice } from "../../ui/Choice";
import { Popup } from "../../ui/Popup";
import { useReasonByRole } from "../access/session";
import styles from "./Presets.module.css";

interface PresetsProps {
  /** What would be kept now; null while it is not known. */
  readonly present: PresetBody | null;
  /** Stages what a preset comes to. */
  readonly stage: (preset: Preset) => void;
}

/** Read with each connection, when the list is opened, and again after a change of one's own. */
function usePresets(): { readonly presets: readonly Preset[]; readonly readAgain: () => void } {
  const connections = useView((view) => view.connections);
  // Without an answer the choice stays as it is, and the link's own notice says why.
  const { data, refetch } = useQuery({ queryKey: ["presets", connections], queryFn: readPresets, placeholderData: keepPreviousData });
  return { presets: data ?? [], readAgain: () => void refetch() };
}

/** What becomes of the preset that has this name now. */
function wordsOf(known: Preset | undefined): string {
  if (known === undefined) return "Saves the parameters in force with the staged changes.";
  if (known.preset === null) return `The existing preset cannot be read (${known.refusal ?? "no reason given"}) and will be replaced.`;
  return [`Saved by ${known.preset.who}; it will be replaced.`, ...known.notices].join(" ");
}

export function Presets({ present, stage }: PresetsProps) {
  const { presets, readAgain } = usePresets();
  const { runAction, waiting, refusal } = useAction();
  const byRole = useReasonByRole("operator");
  const [name, setName] = useState("");
  const known = presets.find((preset) => preset.name === name.trim());
  const change = (work: () => Promise<unknown>): void => void runAction(() => work().then(readAgain));
  return (
    <div className={styles.presets}>
      <Choice
        aria-label="Preset to stage"
        value=""
        onFocus={readAgain}
        data={[
          { value: "", label: presets.length === 0 ? "No presets yet" : "Stage a preset" },
          ...presets.map(({ name, preset, config }) => ({ value: name, label: preset === null ? `${name} (cannot be read)` : name, disabled: config === null })),
        ]}
        onChange={(value) => {
          const chosen = presets.find((preset) => preset.name === value);
          if (chosen === undefined) return;
          setName(chosen.name);
          stage(chosen);
        }}
      />
      <Popup
        target={
          <Button disabled={byRole !== null} title={byRole ?? undefined}>
            Save as
          </Button>
        }
      >
        <div className={styles.keep}>
          <TextInput aria-label="Preset name" placeholder="for example: soft hands" maxLength={40} value={name} onChange={(event) => { setName(event.currentTarget.value); }} />
          <p>{wordsOf(known)}</p>
          <div className={styles.pair}>
            <Button variant="filled" loading={waiting} disabled={name.trim() === "" || present === null} onClick={() => { if (present !== null) change(() => keepPreset(name.trim(), present)); }}>
              {known ? "Replace" : "Save"}
            </Button>
            {known && <ConfirmButton label="Delete" question="Delete permanently?" disabledReason={null} onConfirm={() => { change(() => removePreset(known.name)); }} />}
          </div>
          {refusal !== null && <p role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
        </div>
      </Popup>
    </div>
  );
}

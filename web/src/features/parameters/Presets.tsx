/** Parameters kept by name: chosen, they are staged like any edit; what is in force and staged is kept by a name. */
import { Button, TextInput } from "@mantine/core";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { ConfirmButton } from "../../ui/ConfirmButton";
import { useDoing } from "../../api/use-doing";
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
  if (known === undefined) return "Keeps what is in force, with what is staged.";
  if (known.preset === null) return `It cannot be read (${known.refusal ?? "no reason given"}), and would be replaced.`;
  return [`Kept by ${known.preset.who}; it would be replaced.`, ...known.notices].join(" ");
}

export function Presets({ present, stage }: PresetsProps) {
  const { presets, readAgain } = usePresets();
  const { doing, waiting, refusal } = useDoing();
  const byRole = useReasonByRole("operator");
  const [name, setName] = useState("");
  const known = presets.find((preset) => preset.name === name.trim());
  const change = (work: () => Promise<unknown>): void => void doing(() => work().then(readAgain));
  return (
    <div className={styles.presets}>
      <Choice
        aria-label="Preset to stage"
        value=""
        onFocus={readAgain}
        data={[
          { value: "", label: presets.length === 0 ? "No preset kept yet" : "Stage a preset" },
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
            Keep as
          </Button>
        }
      >
        <div className={styles.keep}>
          <TextInput aria-label="Name of the preset" placeholder="such as: soft hands" maxLength={40} value={name} onChange={(event) => { setName(event.currentTarget.value); }} />
          <p>{wordsOf(known)}</p>
          <div className={styles.pair}>
            <Button variant="filled" loading={waiting} disabled={name.trim() === "" || present === null} onClick={() => { if (present !== null) change(() => keepPreset(name.trim(), present)); }}>
              {known ? "Replace" : "Keep"}
            </Button>
            {known && <ConfirmButton label="Remove" question="Really remove?" against={null} onConfirm={() => { change(() => removePreset(known.name)); }} />}
          </div>
          {refusal !== null && <p role="alert">{`${refusal.message} ${refusal.tip}`}</p>}
        </div>
      </Popup>
    </div>
  );
}

/** Big figures, to be read across the room: nothing of it is pressed. */
import type { ReactNode } from "react";
import { isPhase, PHASE_WORDS } from "../../source/phases";
import { useSnapshot } from "../../store/context";
import { usePreferences } from "../../units/preferences";
import { clock, fixed, MILLIMETRES, MILLIMETRES_PER_SECOND, shown } from "../../units/units";
import { forceWords } from "./cells";
import styles from "./WallView.module.css";

interface FigureProps {
  readonly label: string;
  readonly value: string;
  readonly unit?: string;
  readonly remark?: string;
  readonly tone?: "left" | "right" | "calm" | "error" | undefined;
  readonly wide?: boolean;
}

function Figure({ label, value, unit = "", remark = "", tone, wide = false }: FigureProps): ReactNode {
  return (
    <div className={styles.figure} data-tone={tone} data-wide={wide || undefined} role="group" aria-label={label}>
      <h2>{label}</h2>
      <p className={styles.value}>
        {value} <small>{unit}</small>
      </p>
      <p className={styles.remark}>{remark}</p>
    </div>
  );
}

function Hand({ arm }: { readonly arm: "left" | "right" }) {
  const contact = useSnapshot((snapshot) => snapshot[arm].in_contact) ?? false;
  const force = useSnapshot((snapshot) => Math.hypot(snapshot[arm].hand_wrench[0], snapshot[arm].hand_wrench[1])) ?? 0;
  return <Figure label={`${arm === "left" ? "Left" : "Right"} hand`} value={contact ? forceWords(force) : "free"} unit={contact ? "N" : ""} remark={contact ? "touches" : ""} tone={contact ? arm : undefined} />;
}

function Phase() {
  const phase = useSnapshot((snapshot) => snapshot.phase) ?? "";
  const words = useSnapshot((snapshot) => snapshot.description) ?? "No data yet.";
  const bad = phase === "faulted" || phase === "stopped";
  return <Figure wide label="Phase" value={isPhase(phase) ? PHASE_WORDS[phase] : "—"} remark={words} tone={bad ? "error" : phase === "holding" ? "calm" : undefined} />;
}

function Cage() {
  const margin = useSnapshot((snapshot) => snapshot.cage_margin);
  const closed = useSnapshot((snapshot) => snapshot.cage_closed) ?? false;
  return <Figure wide label="Cage" value={margin !== null ? "Caged" : closed ? "Closed" : "Open"} remark={margin === null ? "" : `margin ${fixed(margin * MILLIMETRES.factor, 1)} mm`} tone={margin === null ? undefined : "calm"} />;
}

export function WallView() {
  const { angles } = usePreferences();
  const time = useSnapshot((snapshot) => snapshot.time);
  const spin = useSnapshot((snapshot) => snapshot.spin) ?? Number.NaN;
  const drift = useSnapshot((snapshot) => snapshot.drift) ?? Number.NaN;
  const attitude = useSnapshot((snapshot) => snapshot.base.pose[2]) ?? Number.NaN;
  const peak = useSnapshot((snapshot) => snapshot.peak_tip_force) ?? Number.NaN;
  const rate = shown("rad/s", angles);
  const angle = shown("rad", angles);
  return (
    <main className={styles.wall} aria-label="Wall view">
      <Phase />
      <Figure wide label="Mission time" value={time === null ? "—" : clock(time, 1)} />
      <Figure label="Target spin" value={fixed(spin * rate.factor, angles === "deg" ? 0 : 2)} unit={rate.unit} />
      <Figure label="Target drift" value={fixed(drift * MILLIMETRES_PER_SECOND.factor, 0)} unit={MILLIMETRES_PER_SECOND.unit} />
      <Hand arm="left" />
      <Hand arm="right" />
      <Figure label="Peak force" value={fixed(peak, 2)} unit="N" remark="so far" />
      <Figure label="Base attitude" value={fixed(attitude * angle.factor, angles === "deg" ? 1 : 3)} unit={angle.unit} />
      <Cage />
    </main>
  );
}

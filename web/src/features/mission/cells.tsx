/** The strip's smaller readouts. */
import { Tooltip } from "@mantine/core";
import type { MissionSnapshot } from "../../api/types";
import { Term } from "../glossary/Term";
import { useSnapshot } from "../../store/context";
import { Icon, type IconName } from "../../ui/theme/Icon";
import { fixed, MILLIMETRES, MILLIMETRES_PER_SECOND } from "../../units/units";
import { Cell, Reading, Remark } from "./Cell";
import styles from "./cells.module.css";

export function DriftCell() {
  const drift = useSnapshot((snapshot) => snapshot.drift) ?? Number.NaN;
  return (
    <Cell label="Target drift" term="target_drift" width={110}>
      <Reading value={fixed(drift * MILLIMETRES_PER_SECOND.factor, 1)} unit={MILLIMETRES_PER_SECOND.unit} />
    </Cell>
  );
}

interface HandProps {
  readonly arm: "left" | "right";
}

const freeWords = (contact: boolean | null): string => (contact === null ? "—" : "free");

function Hand({ arm }: HandProps) {
  const contact = useSnapshot((snapshot) => snapshot[arm].in_contact);
  const force = useSnapshot((snapshot) => Math.hypot(snapshot[arm].hand_wrench[0], snapshot[arm].hand_wrench[1])) ?? 0;
  const touching = contact === true;
  const name = arm === "left" ? "Left" : "Right";
  return (
    <div className={styles.hand} data-arm={arm} data-touching={touching || undefined}>
      <span className={styles.sign}>{name.charAt(0)}</span>
      <span className="visually-hidden">{`${name} hand ${touching ? "touches" : "is free"}`}</span>
      <span className={styles.force}>{touching ? forceWords(force) : freeWords(contact)}</span>
      {touching && <span className={styles.unit}>N</span>}
    </div>
  );
}

/** Of a touch, whose force is never nothing. */
export const forceWords = (force: number): string => (force < 0.01 ? "< 0.01" : fixed(force, 2));

export function ContactCell() {
  const peak = useSnapshot((snapshot) => snapshot.peak_tip_force) ?? Number.NaN;
  return (
    <Cell label="Contact" term="contact" width={222}>
      <div className={styles.hands}>
        <Hand arm="left" />
        <Hand arm="right" />
      </div>
      <Remark>peak so far {fixed(peak, 3)} N</Remark>
    </Cell>
  );
}

function cageWords(closed: boolean | null, margin: number | null): string {
  if (margin !== null) return "Caged";
  if (closed === null) return "—";
  return closed ? "Closed" : "Open";
}

export function CageCell() {
  const closed = useSnapshot((snapshot) => snapshot.cage_closed);
  const margin = useSnapshot((snapshot) => snapshot.cage_margin);
  return (
    <Cell label="Cage" term="cage" width={128}>
      <div className={styles.word}>
        {margin !== null && <Icon icon="lock" size={16} />}
        {cageWords(closed, margin)}
      </div>
      <Remark><Term term="cage_margin">margin</Term> {margin === null ? "—" : `${fixed(margin * MILLIMETRES.factor, 1)} mm`}</Remark>
    </Cell>
  );
}

type Readiness = MissionSnapshot["readiness"];

interface Reason {
  readonly icon: IconName;
  readonly words: string;
}

/** What there is room for: of what is waited for, else of what is met. The tip has all. */
export function shownReasons(reasons: readonly Reason[]): readonly Reason[] {
  const unmet = reasons.filter(({ icon }) => icon !== "check");
  return (unmet.length > 0 ? unmet : reasons).slice(0, 2);
}

/** Unmet first: they are what is waited for. */
export function reasonsOf(readiness: Readiness): readonly Reason[] {
  const conditions = [...readiness.conditions]
    .sort((one, other) => Number(one.met) - Number(other.met))
    .map(({ met, words }) => ({ icon: met ? ("check" as const) : ("cross" as const), words }));
  return readiness.blocked === null ? conditions : [{ icon: "bar", words: readiness.blocked }, ...conditions];
}

export function goWords({ go, blocked }: Readiness): string {
  if (blocked !== null) return "Blocked";
  return go ? "Go" : "No go";
}

/** All of them, whole: the strip has room for two lines. */
function ReasonList({ reasons }: { readonly reasons: readonly Reason[] }) {
  return (
    <ul>
      {reasons.map(({ icon, words }) => (
        <li key={words}>
          <Icon icon={icon} size={11} /> {words}
        </li>
      ))}
    </ul>
  );
}

/** As one text: numbers behind the words change all the time, the words seldom. */
const reasonsText = (readiness: Readiness): string => JSON.stringify(reasonsOf(readiness));

export function NextCell() {
  const next = useSnapshot(({ readiness }) => readiness.next.replaceAll("_", " "));
  const verdict = useSnapshot(({ readiness }) => goWords(readiness));
  const go = useSnapshot(({ readiness }) => readiness.go) ?? false;
  const reasons = JSON.parse(useSnapshot(({ readiness }) => reasonsText(readiness)) ?? "[]") as readonly Reason[];
  return (
    <Cell label={`Next: ${next ?? "—"}`} term="next_phase" width={236}>
      <div className={styles.go} data-go={go || undefined}>
        {verdict !== null && <Icon icon={go ? "check" : "bar"} size={16} />}
        {verdict ?? "—"}
      </div>
      <Tooltip label={<ReasonList reasons={reasons} />} w={320} disabled={reasons.length === 0} position="bottom-end">
        <ul className={styles.reasons} tabIndex={reasons.length === 0 ? undefined : 0}>
          {shownReasons(reasons).map(({ icon, words }) => (
            <li key={words} data-icon={icon}>
              <Icon icon={icon} size={11} /> <span className="visually-hidden">{icon === "check" ? "met:" : "unmet:"}</span>
              <span>{words}</span>
            </li>
          ))}
        </ul>
      </Tooltip>
    </Cell>
  );
}

/** Several runs in one plot: any column of the log, or an expression of them, over time or over another one. */
import { ActionIcon, Button, Checkbox } from "@mantine/core";
import { useState, type ReactElement } from "react";
import { flushSync } from "react-dom";
import { createRoot } from "react-dom/client";
import type { History, HistoryColumn } from "../../api/types";
import { hashOf, useHash } from "../../store/route";
import { Choice } from "../../ui/Choice";
import { CopyButton } from "../../ui/CopyButton";
import { EmptyPage } from "../../ui/EmptyPage";
import { csvCell } from "../../ui/export/csv";
import { ExportMenu } from "../../ui/export/ExportMenu";
import { Panel } from "../../ui/Panel";
import { SuggestInput } from "../../ui/SuggestInput";
import { Icon } from "../../ui/theme/Icon";
import { usePreferences } from "../../units/preferences";
import { fixed, shown, type AngleUnit } from "../../units/units";
import { changesTitle, changeWords, configurationWords } from "../library/labels";
import { ALIGNMENTS, overlayHash, overlayOf, TIME, type Overlay } from "../library/overlay-address";
import { VerdictMark, verdictWords } from "../library/Verdict";
import { ALIGNMENT_WORDS, curveOf, extentOf, missingWords, nearestRow, type Extent, type OverlayCurve } from "./curves";
import { expressionOf, FUNCTION_NAMES, type Expression, type Fault } from "./expression";
import { OverlayPicture, type DrawnCurve, type Ink } from "./OverlayPicture";
import { OverlayPlot, type Cursor } from "./OverlayPlot";
import styles from "./OverlayPage.module.css";
import { useColumns, useOverlaid, type OverlaidRun } from "./use-overlay";

/** Hues that stand out in either theme, each twice: whole, and dashed. */
const TOKENS = ["left", "right", "target", "base", "warning", "error"] as const;
/** Okabe and Ito's on white. */
const ON_PAPER = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9"] as const;
const WHITE: Ink = { ground: "#ffffff", text: "#1a1a1a", grid: "#e3e3e3", axis: "#1a1a1a" };
const FIGURE = { width: 860, height: 520 } as const;

/** What people ask for first. */
const USUAL: readonly { readonly value: string; readonly label: string }[] = [
  { value: "max(left.hand_force, right.hand_force)", label: "larger tip force, N" },
  { value: "target.twist.angle", label: "spin of the target, rad/s" },
  { value: "hypot(target.twist.x, target.twist.y)", label: "drift of the target, m/s" },
  { value: "min(left.manipulability, right.manipulability)", label: "lesser manipulability, m²" },
];

const show = (overlay: Overlay): void => { location.replace(overlayHash(overlay)); };

/** What tells a run from its neighbours. */
function labelOf({ id, run }: OverlaidRun): string {
  if (run === null) return id;
  if (run.name !== "") return run.name;
  // What was changed first: the rest may be cut off.
  return [...run.changes.map(changeWords), configurationWords(run), `seed ${run.seed}`].join(", ");
}

interface Axis {
  readonly expression: Expression;
  readonly factor: number;
  readonly unit: string;
}

/** An expression as a person reads it. */
function axisOf(read: Expression | Fault, angles: AngleUnit): Axis | null {
  if ("fault" in read) return null;
  const { factor, unit } = shown(read.unit ?? "1", angles);
  return { expression: { ...read, of: (column) => read.of(column) * factor }, factor, unit };
}

interface FieldProps {
  readonly name: string;
  readonly value: string;
  readonly fault: string | null;
  readonly data: readonly { readonly value: string; readonly label: string }[];
  readonly onChange: (value: string) => void;
}

function ExpressionField({ name, value, fault, data, onChange }: FieldProps) {
  return (
    <div className={styles.field}>
      <SuggestInput label={name} value={value} data={data} error={fault} title={`A column of the log, or an expression of them: + - * / ^, ${FUNCTION_NAMES.join(", ")}`} onChange={onChange} spellCheck={false} />
    </div>
  );
}

interface EntryProps {
  readonly of: OverlaidRun;
  readonly missing: string | null;
  readonly value: string;
  readonly hidden: boolean;
  readonly onHide: (hidden: boolean) => void;
  readonly onRemove: () => void;
  readonly token: string;
  readonly dash: string | undefined;
}

/** A run in the legend, with its value under the cursor. */
function Entry({ of, missing, value, hidden, onHide, onRemove, token, dash }: EntryProps) {
  const { run } = of;
  return (
    <li className={styles.entry} data-hidden={hidden || undefined}>
      <Checkbox size="xs" aria-label={`Show ${labelOf(of)}`} checked={!hidden} onChange={(event) => { onHide(!event.currentTarget.checked); }} />
      <svg width="26" height="8" aria-hidden="true"><line x1="0" y1="4" x2="26" y2="4" stroke={`var(--${token})`} strokeWidth="2.5" strokeDasharray={dash} /></svg>
      <a href={hashOf({ page: "runs", item: of.id })} title={run === null ? of.id : `${of.id}\n${changesTitle(run.changes)}`}>{labelOf(of)}</a>
      <output>{value}</output>
      <ActionIcon size={18} variant="subtle" color="gray" aria-label={`Take ${labelOf(of)} out`} onClick={onRemove}><Icon icon="cross" size={9} /></ActionIcon>
      <small>
        {run !== null && <><VerdictMark run={run} /> {verdictWords(run)}</>}
        {missing !== null && <strong>{` ${missing}`}</strong>}
        {of.trouble !== null && <strong role="alert">{` ${of.trouble}`}</strong>}
      </small>
    </li>
  );
}

/** Markup of the one `<svg>` of a picture. */
function markupOf(picture: ReactElement): string {
  const holder = document.createElement("div");
  const root = createRoot(holder);
  flushSync(() => { root.render(picture); });
  const svg = holder.querySelector("svg");
  const markup = svg === null ? "" : new XMLSerializer().serializeToString(svg);
  root.unmount();
  return markup;
}

function tableOf(curves: readonly DrawnCurve[], xLabel: string, yLabel: string): string {
  const rows = curves.flatMap(({ run, label, xs, ys }) => Array.from(xs, (x, row) => [run, label, x, ys[row] ?? Number.NaN] as const).filter(([, , x, y]) => Number.isFinite(x) && Number.isFinite(y)));
  return [["run", "label", xLabel, yLabel], ...rows].map((row) => row.map(csvCell).join(",")).join("\r\n") + "\r\n";
}

const DASH = "7 3";

const unitsOf = (columns: readonly HistoryColumn[]): ReadonlyMap<string, string> => new Map(columns.map(({ name, unit }) => [name, unit]));

/** Everything that is drawn, from what is asked for and what is stored. */
function useDrawn(overlay: Overlay, columns: readonly HistoryColumn[], typed: { readonly x: string; readonly y: string }) {
  const { angles } = usePreferences();
  const units = unitsOf(columns);
  const faultOf = (text: string): string | null => {
    const read = expressionOf(text, units);
    return "fault" in read && columns.length > 0 ? read.fault : null;
  };
  const [readX, readY] = [expressionOf(overlay.x, units), expressionOf(overlay.y, units)];
  const needed = "fault" in readX || "fault" in readY ? [] : [...readX.columns, ...readY.columns];
  const runs = useOverlaid(overlay.runs, needed);
  const [x, y] = [axisOf(readX, angles), axisOf(readY, angles)];
  return { columns, runs, timed: overlay.x.trim() === TIME, x, y, faults: { x: faultOf(typed.x), y: faultOf(typed.y) } };
}

type Drawn = ReturnType<typeof useDrawn>;

/** Curves of a dozen runs are long: each is made once for what is stored and asked. */
const made = new WeakMap<History, Map<string, OverlayCurve>>();

function curveOnce(history: History, question: string, make: () => OverlayCurve): OverlayCurve {
  const known = made.get(history) ?? new Map<string, OverlayCurve>();
  made.set(history, known);
  const curve = known.get(question) ?? make();
  known.set(question, curve);
  return curve;
}

interface Drawable {
  readonly curves: readonly DrawnCurve[];
  /** Why a run has none. */
  readonly missing: ReadonlyMap<string, string>;
}

const tokenOf = (place: number): string => TOKENS[place % TOKENS.length] ?? "left";
const dashOf = (place: number): string | undefined => (place < TOKENS.length ? undefined : DASH);

function drawableOf({ runs, timed, x, y }: Drawn, { align, ...asked }: Overlay): Drawable {
  const missing = new Map<string, string>();
  const curves = runs.flatMap((of, place): DrawnCurve[] => {
    const { run, history } = of;
    if (run === null || history === null || x === null || y === null) return [];
    const why = missingWords(align, asked.x, run, history);
    if (why !== null) missing.set(of.id, why);
    if (why !== null) return [];
    const question = [asked.x, asked.y, align, x.factor, y.factor].join("\n");
    const curve = curveOnce(history, question, () => curveOf(run, history, x.expression, y.expression, timed, align));
    return [{ ...curve, label: labelOf(of), colour: `var(--${tokenOf(place)})`, dash: dashOf(place) }];
  });
  return { curves, missing };
}

/** The same on white, in colours that stand out there. */
const onPaper = (curves: readonly DrawnCurve[], runs: readonly OverlaidRun[]): readonly DrawnCurve[] =>
  curves.map((curve) => ({ ...curve, colour: ON_PAPER[runs.findIndex(({ id }) => id === curve.run) % ON_PAPER.length] ?? WHITE.text }));

const withUnit = (words: string, unit: string): string => (unit === "" ? words : `${words}, ${unit}`);

function labelsOf({ timed, x, y }: Drawn, overlay: Overlay): { readonly x: string; readonly y: string } {
  const time = overlay.align === "clock" ? "Mission time, s" : `Time after ${ALIGNMENT_WORDS[overlay.align]}, s`;
  return { x: timed ? time : withUnit(overlay.x, x?.unit ?? ""), y: withUnit(overlay.y, y?.unit ?? "") };
}

/** Significant figures of a value under the cursor. */
const FIGURES = 4;

function readoutOf(curve: DrawnCurve | undefined, cursor: Cursor | null, whole: Extent | null): string {
  if (curve === undefined || cursor === null || whole === null) return "";
  const scale = { x: 1 / (whole.x[1] - whole.x[0]), y: 1 / (whole.y[1] - whole.y[0]) };
  const row = nearestRow(curve, cursor.x, cursor.y, scale);
  if (row < 0) return "—";
  const value = curve.ys[row] ?? Number.NaN;
  const decimals = Math.max(0, FIGURES - 1 - Math.max(0, Math.floor(Math.log10(Math.max(1e-9, Math.abs(value))))));
  return fixed(value, Math.min(decimals, FIGURES));
}

interface FormProps {
  readonly drawn: Drawn;
  readonly overlay: Overlay;
  readonly typed: { readonly x: string; readonly y: string };
  readonly onTyped: (change: Partial<{ x: string; y: string }>) => void;
}

function Form({ drawn, overlay, typed, onTyped }: FormProps) {
  const data = [...USUAL, ...drawn.columns.map(({ name, unit }) => ({ value: name, label: shown(unit, "rad").unit }))];
  return (
    <div className={styles.form}>
      <ExpressionField name="Upright" value={typed.y} fault={drawn.faults.y} data={data} onChange={(y) => { onTyped({ y }); }} />
      <ExpressionField name="Across" value={typed.x} fault={drawn.faults.x} data={[{ value: TIME, label: "time" }, ...data]} onChange={(x) => { onTyped({ x }); }} />
      <Choice label="Aligned at" disabled={!drawn.timed} value={overlay.align} data={ALIGNMENTS.map((value) => ({ value, label: ALIGNMENT_WORDS[value] }))} onChange={(value) => { show({ ...overlay, align: ALIGNMENTS.find((known) => known === value) ?? "touch" }); }} />
    </div>
  );
}

interface LegendProps {
  readonly drawn: Drawn;
  readonly overlay: Overlay;
  readonly drawable: Drawable;
  readonly hidden: ReadonlySet<string>;
  readonly onHidden: (hidden: ReadonlySet<string>) => void;
  readonly cursor: Cursor | null;
  readonly whole: Extent | null;
}

function Legend({ drawn, overlay, drawable: { curves, missing }, hidden, onHidden, cursor, whole }: LegendProps) {
  return (
    <Panel title={`${overlay.runs.length} runs`} grow aside={<output id="overlay-values" className={styles.at}>{cursor === null ? "" : `at ${fixed(cursor.x, 3)}`}</output>}>
      <ul className={styles.legend}>
        {drawn.runs.map((of, place) => (
          <Entry
            key={of.id}
            of={of}
            token={tokenOf(place)}
            dash={dashOf(place)}
            missing={missing.get(of.id) ?? null}
            value={hidden.has(of.id) ? "" : readoutOf(curves.find(({ run }) => run === of.id), cursor, whole)}
            hidden={hidden.has(of.id)}
            onHide={(hide) => { onHidden(new Set(hide ? [...hidden, of.id] : [...hidden].filter((id) => id !== of.id))); }}
            onRemove={() => { show({ ...overlay, runs: overlay.runs.filter((id) => id !== of.id) }); }}
          />
        ))}
      </ul>
    </Panel>
  );
}

/** What is typed, which the address follows as soon as it can be understood. */
function useTyped(overlay: Overlay, columns: Drawn["columns"], onShown: () => void): readonly [FormProps["typed"], FormProps["onTyped"]] {
  const [typed, setTyped] = useState<FormProps["typed"] | null>(null);
  const fields = typed ?? { x: overlay.x, y: overlay.y };
  return [
    fields,
    (change) => {
      const next = { ...fields, ...change };
      setTyped(next);
      const units = unitsOf(columns);
      if ("fault" in expressionOf(next.x, units) || "fault" in expressionOf(next.y, units)) return;
      onShown();
      show({ ...overlay, ...next });
    },
  ];
}

interface ToolsProps {
  readonly labels: { readonly x: string; readonly y: string };
  readonly seen: readonly DrawnCurve[];
  readonly runs: readonly OverlaidRun[];
  readonly whole: Extent | null;
  readonly zoom: readonly [number, number] | null;
  readonly onWhole: () => void;
}

function Tools({ labels, seen, runs, whole, zoom, onWhole }: ToolsProps) {
  const draw = (): string => {
    if (whole === null) throw new Error("There is nothing to export yet.");
    const size = { ...FIGURE, height: FIGURE.height + 8 * seen.length };
    return markupOf(<OverlayPicture curves={onPaper(seen, runs)} extent={{ x: zoom ?? whole.x, y: whole.y }} size={size} xLabel={labels.x} yLabel={labels.y} ink={WHITE} title={`${labels.y}: ${seen.length} runs`} />);
  };
  const table = (): string => tableOf(zoom === null ? seen : seen.map((curve) => cut(curve, zoom)), labels.x, labels.y);
  return (
    <div className={styles.tools}>
      {zoom !== null && <Button size="compact-xs" onClick={onWhole}>Whole</Button>}
      <CopyButton compact label="Copy link" title="Copy the address of this plot" text={() => location.href} />
      <ExportMenu what="this plot" name="becalm-runs" draw={draw} table={table} />
    </div>
  );
}

function Plots({ overlay }: { readonly overlay: Overlay }) {
  const columns = useColumns(overlay.runs[0]);
  const [zoom, setZoom] = useState<readonly [number, number] | null>(null);
  const [typed, onTyped] = useTyped(overlay, columns, () => { setZoom(null); });
  const drawn = useDrawn(overlay, columns, typed);
  const drawable = drawableOf(drawn, overlay);
  const [hidden, setHidden] = useState<ReadonlySet<string>>(new Set());
  const [cursor, setCursor] = useState<Cursor | null>(null);
  const seen = drawable.curves.filter(({ run }) => !hidden.has(run));
  const whole = extentOf(seen);
  const labels = labelsOf(drawn, overlay);
  const reading = drawn.runs.some(({ history, trouble }) => history === null && trouble === null);
  return (
    <div className={styles.columns}>
      <Panel title="Runs over one another" grow aside={<Tools labels={labels} seen={seen} runs={drawn.runs} whole={whole} zoom={zoom} onWhole={() => { setZoom(null); }} />}>
        <Form drawn={drawn} overlay={overlay} typed={typed} onTyped={onTyped} />
        {whole === null ? (
          <p className={styles.hint} role="status">{reading ? "Reading the runs." : "Nothing to draw: see the runs at the right."}</p>
        ) : (
          <OverlayPlot curves={seen} whole={whole} timed={drawn.timed} xLabel={labels.x} yLabel={labels.y} cursor={cursor} onCursor={setCursor} zoom={zoom} onZoom={setZoom} />
        )}
        <p className={styles.hint}>Drag to zoom, double click for the whole. Keys: arrows read, Shift for larger steps, + and − zoom, Home for the whole.</p>
      </Panel>
      <Legend drawn={drawn} overlay={overlay} drawable={drawable} hidden={hidden} onHidden={setHidden} cursor={cursor} whole={whole} />
    </div>
  );
}

/** What of a curve stands within a stretch. */
function cut(curve: DrawnCurve, [low, high]: readonly [number, number]): DrawnCurve {
  const rows = Array.from(curve.xs.keys()).filter((row) => (curve.xs[row] ?? Number.NaN) >= low && (curve.xs[row] ?? Number.NaN) <= high);
  return { ...curve, xs: Float64Array.from(rows, (row) => curve.xs[row] ?? Number.NaN), ys: Float64Array.from(rows, (row) => curve.ys[row] ?? Number.NaN) };
}

export function OverlayPage({ shown: isShown }: { readonly shown: boolean }) {
  const hash = useHash();
  if (!isShown) return null;
  const overlay = overlayOf(hash);
  return (
    <main className={styles.page}>
      <a className={styles.all} href="#/runs">All runs</a>
      {overlay.runs.length === 0 ? <EmptyPage label="No runs chosen" title="No runs in this plot" words="Select runs in the table of runs, then press Plot together." /> : <Plots overlay={overlay} />}
    </main>
  );
}

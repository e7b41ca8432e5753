/** Saves the scene of a replay as a still or as a film, drawn by this browser from the log. */
import { Button, Progress, TextInput } from "@mantine/core";
import { useRef, useState } from "react";
import { SPEEDS, type Playback } from "../../source/playback";
import type { Source } from "../../source/source";
import { Choice } from "../../ui/Choice";
import { saveFile } from "../../ui/export/save-file";
import { Popup } from "../../ui/Popup";
import { useView } from "../../store/context";
import { useKept } from "../../ui/use-kept";
import { readNumber } from "../../units/numbers";
import { clock, fixed } from "../../units/units";
import { useDetail } from "../scene/detail";
import { drawnPicture } from "../scene/picture";
import { canFilm, filmed, GROUNDS, momentsOf, RATES, refusalOf, Sheet, SIZES, type FilmPlan, type Frame, type Ground } from "./film";
import styles from "./PictureMenu.module.css";

type Take = NonNullable<Source["takePicture"]>;

const SIZE_NAMES = Object.keys(SIZES);
const GROUND_WORDS: Readonly<Record<Ground, string>> = { transparent: "Transparent", night: "As on the page", white: "White" };

/** A light scene has half of the pixels each way: it is asked for twice as many. */
const LIGHT_SCALE = 2;

const namesOf = (values: readonly number[], unit: string) => values.map((value) => ({ value: String(value), label: `${value} ${unit}` }));

const valueOf = (typed: string): number => {
  const read = readNumber(typed);
  return "value" in read ? read.value : Number.NaN;
};

type Work =
  | { readonly state: "idle" }
  | { readonly state: "busy"; readonly done: number; readonly total: number }
  | { readonly state: "failed"; readonly why: string };

interface Studio {
  readonly work: Work;
  /** Whether there is something to take a picture of, and no other is being taken. */
  readonly ready: boolean;
  readonly saveStill: (size: Frame, ground: Ground, name: string) => void;
  readonly saveFilm: (plan: FilmPlan, size: Frame, ground: Ground, name: string) => void;
  readonly cancel: () => void;
}

let pictures = 0;

const nextName = (): string => {
  pictures += 1;
  return `picture-${pictures}`;
};

/** One still or film at a time; the replay then shows its own moment again. */
function useStudio(playback: Playback, takePicture: Take, seen: boolean): Studio {
  const [work, setWork] = useState<Work>({ state: "idle" });
  const { detail } = useDetail();
  const given = useRef<AbortController>(new AbortController());
  const scale = detail === "light" ? LIGHT_SCALE : 1;
  const take = ({ width, height }: Frame) => (time: number): Promise<Blob> => {
    const name = nextName();
    return drawnPicture(name, () => { takePicture({ name, time, width: scale * width, height: scale * height }); }, given.current.signal);
  };
  const run = async (job: () => Promise<Blob>, name: string): Promise<void> => {
    given.current = new AbortController();
    playback.pause();
    setWork({ state: "busy", done: 0, total: 1 });
    try {
      saveFile(await job(), name);
      setWork({ state: "idle" });
    } catch (cause) {
      setWork(given.current.signal.aborted ? { state: "idle" } : { state: "failed", why: cause instanceof Error ? cause.message : String(cause) });
    }
    playback.showAgain();
  };
  return {
    work,
    ready: seen && work.state !== "busy",
    saveStill: (size, ground, name) =>
      void run(async () => {
        const sheet = new Sheet(size, ground);
        await sheet.put(await take(size)(playback.read().time));
        return sheet.still();
      }, `${name}.png`),
    saveFilm: (plan, size, ground, name) =>
      void run(() => filmed(plan, new Sheet(size, ground), take(size), (done, total) => { setWork({ state: "busy", done, total }); }), `${name}.webm`),
    cancel: () => { given.current.abort(); },
  };
}

/** What a film is made of, as it is typed. */
function useFilmPlan(playback: Playback, end: number) {
  const [from, setFrom] = useState<string | null>(null);
  const [to, setTo] = useState<string | null>(null);
  const [speed, setSpeed] = useState("1");
  const [rate, setRate] = useState("30");
  const texts = { from: from ?? fixed(playback.start, 3), to: to ?? fixed(end, 3) };
  const plan: FilmPlan = { from: valueOf(texts.from), to: valueOf(texts.to), speed: Number(speed), rate: Number(rate) };
  return { texts, plan, speed, rate, setFrom, setTo, setSpeed, setRate };
}

function FilmForm({ playback, size, name, studio }: { readonly playback: Playback; readonly size: Frame; readonly name: string; readonly studio: Studio }) {
  const { end } = playback.read();
  const { texts, plan, speed, rate, setFrom, setTo, setSpeed, setRate } = useFilmPlan(playback, end);
  const trouble = canFilm() ? refusalOf(plan, end + playback.period) : "This browser has no video encoder.";
  const frames = trouble === null ? momentsOf(plan).length : 0;
  return (
    <fieldset className={styles.part}>
      <legend>Film</legend>
      <div className={styles.row}>
        <TextInput size="xs" label="From, s" value={texts.from} onChange={(event) => { setFrom(event.currentTarget.value); }} />
        <TextInput size="xs" label="To, s" value={texts.to} onChange={(event) => { setTo(event.currentTarget.value); }} />
      </div>
      <div className={styles.row}>
        <Choice within aria-label="Speed of the film" value={speed} data={namesOf(SPEEDS, "× real time")} onChange={setSpeed} />
        <Choice within aria-label="Frames a second" value={rate} data={namesOf(RATES, "frames a second")} onChange={setRate} />
      </div>
      <p role="status">{trouble ?? `${frames} frames, ${fixed(frames / plan.rate, 1)} s. Keep the scene in view while it is drawn.`}</p>
      <Button size="compact-sm" disabled={trouble !== null || !studio.ready} onClick={() => { studio.saveFilm(plan, size, "night", name); }}>
        Save film (WebM)
      </Button>
    </fieldset>
  );
}

function StillForm({ playback, size, name, studio }: { readonly playback: Playback; readonly size: Frame; readonly name: string; readonly studio: Studio }) {
  const [ground, setGround] = useKept<Ground>("becalm-still-ground", "transparent", GROUNDS);
  const { time } = playback.read();
  return (
    <fieldset className={styles.part}>
      <legend>Still</legend>
      <Choice within aria-label="Background of the still" value={ground} data={GROUNDS.map((value) => ({ value, label: GROUND_WORDS[value] }))} onChange={(value) => { setGround(GROUNDS.find((each) => each === value) ?? "transparent"); }} />
      <Button size="compact-sm" disabled={!studio.ready} onClick={() => { studio.saveStill(size, ground, `${name}-${fixed(time, 3)}s`); }}>
        {`Save still of ${clock(time)} (PNG)`}
      </Button>
    </fieldset>
  );
}

/** How far it is, or why it has failed. */
function Progressing({ studio }: { readonly studio: Studio }) {
  const { work } = studio;
  if (work.state === "failed") return <p role="alert">{work.why}</p>;
  if (work.state === "idle") return null;
  return (
    <div className={styles.busy}>
      <Progress size={4} value={(100 * work.done) / work.total} aria-label="Frames that are drawn" />
      <span role="status">{work.total > 1 ? `frame ${work.done} of ${work.total}` : "drawing"}</span>
      <Button size="compact-xs" onClick={studio.cancel}>Cancel</Button>
    </div>
  );
}

interface PictureMenuProps {
  readonly playback: Playback;
  readonly takePicture: Take;
  /** Whether the scene shows robot and target. */
  readonly drawn: boolean;
}

export function PictureMenu({ playback, takePicture, drawn }: PictureMenuProps) {
  const run = useView((view) => view.run?.id ?? null);
  // Until a moment has been told, nothing in the scene stands where it belongs.
  const told = useView((view) => view.snapshot !== null);
  const seen = drawn && told && run !== null;
  const studio = useStudio(playback, takePicture, seen);
  const [sizeName, setSizeName] = useKept("becalm-picture-size", "1920 × 1080", SIZE_NAMES);
  const size = SIZES[sizeName] ?? { width: 1920, height: 1080 };
  const name = `becalm-${run ?? "run"}`;
  const share = studio.work.state === "busy" && studio.work.total > 1 ? ` ${Math.round((100 * studio.work.done) / studio.work.total)} %` : "";
  return (
    <Popup target={<Button size="compact-sm" title="Save the scene as a still or as a film">{`Picture${share}`}</Button>}>
      <div className={styles.menu}>
        <Choice within label="Size, pixels" value={sizeName} data={SIZE_NAMES} onChange={setSizeName} />
        <StillForm playback={playback} size={size} name={name} studio={studio} />
        <FilmForm playback={playback} size={size} name={name} studio={studio} />
        {!seen && <p role="status">A picture can be taken once the scene shows robot and target.</p>}
        <Progressing studio={studio} />
      </div>
    </Popup>
  );
}

/** A recorded run in the scene: what was at the moment that the clock shows, and the clock's own controls. */
import { ActionIcon, Button, Slider } from "@mantine/core";
import { useEffect, useRef, useState, useSyncExternalStore } from "react";
import type { MissionSnapshot } from "../../api/types";
import { Icon } from "../../ui/theme/Icon";
import { Choice } from "../../ui/Choice";
import { clock, fixed, MILLIMETRES_PER_SECOND, shown } from "../../units/units";
import { Facts, type Fact } from "../../ui/Facts";
import { usePreferences } from "../../units/preferences";
import { SceneChoices } from "../scene/SceneChoices";
import { sceneAddress, useDetail } from "../scene/detail";
import { SceneFrame } from "../scene/SceneFrame";
import { SPEEDS, type Player } from "./player";
import styles from "./ReplayPanel.module.css";
import { Screening, type Opened } from "./screening";

interface Screened {
  readonly opened: Opened | null;
  readonly snapshot: MissionSnapshot | null;
  readonly ended: string | null;
}

const NOTHING: Screened = { opened: null, snapshot: null, ended: null };

/** The run at the moments of the player, as long as the panel stands. */
function useScreening(run: string, player: Player) {
  const [screened, setScreened] = useState(NOTHING);
  const screening = useRef<Screening | null>(null);
  useEffect(() => {
    const current = new Screening(run, {
      opened: (opened) => { setScreened((before) => ({ ...before, opened })); },
      snapshot: (snapshot) => { setScreened((before) => ({ ...before, snapshot })); },
      ended: (ended) => { setScreened((before) => ({ ...before, ended })); },
    });
    screening.current = current;
    const tell = (): void => { current.show(player.read().time); };
    tell();
    const withdraw = player.subscribe(tell);
    return () => {
      withdraw();
      current.close();
      setScreened(NOTHING);
    };
  }, [run, player]);
  return { ...screened, screening };
}

/** Moves the clock with the browser's frames. */
function useFrames(player: Player): void {
  useEffect(() => {
    let before = performance.now();
    let request = 0;
    const frame = (now: number): void => {
      request = requestAnimationFrame(frame);
      player.advance(now - before);
      before = now;
    };
    request = requestAnimationFrame(frame);
    return () => {
      cancelAnimationFrame(request);
    };
  }, [player]);
}

function MomentFacts({ snapshot }: { readonly snapshot: MissionSnapshot }) {
  const { angles } = usePreferences();
  const rate = shown("rad/s", angles);
  const touching = [snapshot.left.in_contact && "left", snapshot.right.in_contact && "right"].filter((side) => side !== false);
  const facts: readonly Fact[] = [
    ["Spin", `${fixed(snapshot.spin * rate.factor, 3)} ${rate.unit}`],
    ["Drift", `${fixed(snapshot.drift * MILLIMETRES_PER_SECOND.factor, 1)} ${MILLIMETRES_PER_SECOND.unit}`],
    ["Contact", touching.length === 0 ? "none" : touching.join(", ")],
    ["Peak so far", `${fixed(snapshot.peak_tip_force, 3)} N`],
  ];
  return (
    <dl className={styles.facts} aria-label="At this moment">
      <div className={styles.words}>
        <dt>{snapshot.phase}</dt>
        <dd title={snapshot.description}>{snapshot.description}</dd>
      </div>
      <Facts facts={facts} />
    </dl>
  );
}

function Transport({ player, end }: { readonly player: Player; readonly end: number }) {
  const { time, playing, speed } = useSyncExternalStore(player.subscribe, player.read);
  const step = (ticks: number, label: string, sign: "back" | "step") => (
    <ActionIcon aria-label={label} title={label} onClick={() => { player.step(ticks); }}>
      <Icon sign={sign} />
    </ActionIcon>
  );
  return (
    <div className={styles.transport} role="group" aria-label="Replay">
      <Button size="compact-sm" leftSection={<Icon sign={playing ? "pause" : "play"} />} onClick={() => { if (playing) player.pause(); else player.play(); }}>
        {playing ? "Pause" : "Play"}
      </Button>
      {player.start > 0 && (
        <Button size="compact-sm" title={`Nothing moves before ${clock(player.firstMotion)}`} onClick={() => { player.seek(player.start); }}>
          First motion
        </Button>
      )}
      {step(-1, "One tick back", "back")}
      {step(1, "One tick on", "step")}
      <Slider
        className={styles.scrubber ?? ""}
        size="sm"
        thumbLabel="Moment of the run"
        thumbProps={{ "aria-valuetext": clock(time) }}
        label={null}
        min={0}
        max={end}
        step={player.period}
        value={time}
        onChange={(value) => { player.seek(value); }}
      />
      <output className={styles.time}>{clock(time)}</output>
      <Choice
        aria-label="Speed of the replay"
        value={String(speed)}
        data={SPEEDS.map((value) => ({ value: String(value), label: `${value} ×` }))}
        onChange={(value) => { player.choose(Number(value)); }}
      />
    </div>
  );
}

export function ReplayPanel({ run, end, player }: { readonly run: string; readonly end: number; readonly player: Player }) {
  const { opened, snapshot, ended, screening } = useScreening(run, player);
  const { detail } = useDetail();
  useFrames(player);
  useEffect(() => {
    player.extend(end);
  }, [player, end]);
  return (
    <section className={styles.replay} aria-label="Replay in the scene">
      <div className={styles.scene}>
        {opened !== null && ended === null && (
          <SceneFrame
            address={sceneAddress(opened.scene, detail)}
            detail={detail}
            title="3D view of the recorded run"
          />
        )}
        {ended !== null && <p role="alert">{ended}</p>}
        {opened === null && ended === null && <p>Opening the run …</p>}
        {opened !== null && ended === null && (
          <SceneChoices
            view={opened}
            onChange={(change) => { screening.current?.arrange(change); }}
            against={null}
          />
        )}
      </div>
      <Transport player={player} end={end} />
      {snapshot !== null && <MomentFacts snapshot={snapshot} />}
    </section>
  );
}

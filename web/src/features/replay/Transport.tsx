/** The controls of a playback: play, step, drag, speed. */
import { ActionIcon, Button, Slider } from "@mantine/core";
import { useEffect, useSyncExternalStore } from "react";
import { SPEEDS, type Playback } from "../../source/playback";
import type { Source } from "../../source/source";
import { keepMoment } from "../../store/moment";
import { Choice } from "../../ui/Choice";
import { CopyButton } from "../../ui/CopyButton";
import { Icon } from "../../ui/theme/Icon";
import { clock } from "../../units/units";
import { PictureMenu } from "./PictureMenu";
import styles from "./ReplayPanel.module.css";

/** Moves the playback with the browser's frames, while it plays. */
function useFrames(playback: Playback, playing: boolean): void {
  useEffect(() => {
    if (!playing) return undefined;
    let before = performance.now();
    let request = 0;
    const frame = (now: number): void => {
      request = requestAnimationFrame(frame);
      playback.advance(now - before);
      before = now;
    };
    request = requestAnimationFrame(frame);
    return () => {
      cancelAnimationFrame(request);
    };
  }, [playback, playing]);
}

function Step({ playback, ticks, label, icon }: { readonly playback: Playback; readonly ticks: number; readonly label: string; readonly icon: "back" | "step" }) {
  return (
    <ActionIcon aria-label={label} title={label} onClick={() => { playback.step(ticks); }}>
      <Icon icon={icon} />
    </ActionIcon>
  );
}

interface TransportProps {
  readonly playback: Playback;
  readonly takePicture: Source["takePicture"];
  /** Whether the scene shows robot and target. */
  readonly drawn: boolean;
}

export function Transport({ playback, takePicture, drawn }: TransportProps) {
  const { time, playing, speed, end } = useSyncExternalStore(playback.subscribe, playback.read);
  useFrames(playback, playing);
  return (
    <div className={styles.transport} role="group" aria-label="Replay">
      <Button size="compact-sm" leftSection={<Icon icon={playing ? "pause" : "play"} />} onClick={() => { if (playing) playback.pause(); else playback.play(); }}>
        {playing ? "Pause" : "Play"}
      </Button>
      {playback.start > 0 && (
        <Button size="compact-sm" title={`Nothing moves before ${clock(playback.firstMotion)}`} onClick={() => { playback.seek(playback.start); }}>
          First motion
        </Button>
      )}
      <Step playback={playback} ticks={-1} label="One tick back" icon="back" />
      <Step playback={playback} ticks={1} label="One tick forward" icon="step" />
      <Slider
        className={styles.scrubber ?? ""}
        size="sm"
        thumbLabel="Moment of the run"
        thumbProps={{ "aria-valuetext": clock(time) }}
        label={null}
        min={0}
        max={end}
        step={playback.period}
        value={time}
        onChange={(value) => { playback.seek(value); }}
      />
      <output className={styles.time}>{clock(time)}</output>
      <Choice
        aria-label="Speed of the replay"
        value={String(speed)}
        data={SPEEDS.map((value) => ({ value: String(value), label: `${value} ×` }))}
        onChange={(value) => { playback.setSpeed(Number(value)); }}
      />
      {takePicture !== null && <PictureMenu playback={playback} takePicture={takePicture} drawn={drawn} />}
      <CopyButton label="Copy link" title="Copy the address of this moment, with the stretch that the plots show" text={() => { keepMoment({ time }); return location.href; }} />
    </div>
  );
}

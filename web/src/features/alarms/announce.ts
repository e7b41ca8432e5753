/** How alarms reach somebody who does not look: the title and the icon of the tab, a sound, a notification. */
import { useEffect, useRef } from "react";
import { addressOf } from "../../api/address";
import type { Alarm } from "../../api/types";
import { isPhase, PHASE_WORDS } from "../../source/phases";
import { useSnapshot, useView } from "../../store/context";
import { useShared } from "../../ui/use-shared";
import { usePreferences } from "../../units/preferences";
import { highest, newlySpeaking, noticeWords, speaks, titleOf, type AlarmLevel } from "./alarms";

/** Choices of this browser. */
export const SOUND = { key: "becalm-alarm-sound", initial: "off", allowed: ["off", "on"] } as const;
export const NOTIFICATIONS = { key: "becalm-alarm-notifications", initial: "off", allowed: ["off", "on"] } as const;

const BADGES: Readonly<Record<AlarmLevel, string>> = { watch: "", warning: "#f0c83c", critical: "#ff5a3c" };

/** The icon with a badge in the colour of the level. */
function iconOf(level: AlarmLevel | null): string {
  if (level === null || BADGES[level] === "") return addressOf("/favicon.svg");
  const badge =
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32" fill="none"><rect x="11.2" y="11.2" width="9.6" height="9.6" rx="1" transform="rotate(18 16 16)" fill="#4fd1b5"/>' +
    '<path d="M12 3.5C6.6 5.1 3 10 3 16s3.6 10.900 9 12.500" stroke="#56b4e9" stroke-width="3"/>' +
    `<circle cx="23" cy="9" r="8.500" fill="${BADGES[level]}" stroke="#10151c" stroke-width="1.500"/></svg>`;
  return `data:image/svg+xml,${encodeURIComponent(badge)}`;
}

function showIcon(address: string): void {
  const link = document.querySelector<HTMLLinkElement>('link[rel="icon"]');
  if (link !== null && link.href !== address) link.href = address;
}

let speaker: AudioContext | null = null;

/** Two tones for a warning, three higher ones for what is critical; nothing where the browser has no sound yet. */
export function sound(level: AlarmLevel): void {
  speaker ??= new AudioContext();
  void speaker.resume();
  const tones = level === "critical" ? [880, 880, 880] : [587, 440];
  for (const [place, frequency] of tones.entries()) {
    const from = speaker.currentTime + 0.22 * place;
    const [oscillator, volume] = [speaker.createOscillator(), speaker.createGain()];
    oscillator.frequency.value = frequency;
    volume.gain.setValueAtTime(0, from);
    volume.gain.linearRampToValueAtTime(0.25, from + 0.02);
    volume.gain.linearRampToValueAtTime(0, from + 0.18);
    oscillator.connect(volume).connect(speaker.destination);
    oscillator.start(from);
    oscillator.stop(from + 0.2);
  }
}

/** Milliseconds between two soundings of what is critical and nobody has acknowledged. */
const AGAIN = 10_000;

/** Once for the whole console. */
export function useAnnouncements(): void {
  const alarms = useView((view) => view.alarms);
  const phase = useSnapshot((snapshot) => snapshot.phase);
  const { angles } = usePreferences();
  const [withSound] = useShared(SOUND);
  const [withNotices] = useShared(NOTIFICATIONS);
  const before = useRef<readonly Alarm[]>([]);
  const speaking = alarms.filter(speaks);
  const level = highest(speaking);
  useEffect(() => {
    document.title = titleOf(alarms, phase !== null && isPhase(phase) ? PHASE_WORDS[phase] : null);
  }, [alarms, phase]);
  useEffect(() => {
    showIcon(iconOf(level));
  }, [level]);
  useEffect(() => {
    const fresh = newlySpeaking(before.current, alarms);
    before.current = alarms;
    const worst = highest(fresh);
    if (worst === null) return;
    if (withSound === "on") sound(worst);
    if (withNotices === "on" && document.hidden && "Notification" in window && Notification.permission === "granted") {
      for (const alarm of fresh) new Notification("Becalm", { body: noticeWords(alarm, angles), tag: alarm.key });
    }
  }, [alarms, angles, withSound, withNotices]);
  const critical = level === "critical" && withSound === "on";
  useEffect(() => {
    if (!critical) return undefined;
    const timer = setInterval(() => {
      sound("critical");
    }, AGAIN);
    return () => {
      clearInterval(timer);
    };
  }, [critical]);
}

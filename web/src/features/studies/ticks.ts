/** Which values of a map's axis are written beside it, and how, so that no two run into each other. */
import { scaleLinear, scaleLog } from "d3-scale";
import { plain } from "../../units/units";
import type { Value } from "./layout";

/** Width of a letter for its size, on the generous side: there is no measuring before there is a page. */
const LETTER = 0.58;

export const textWidth = (text: string, size: number): number => text.length * size * LETTER;

export interface Tick {
  /** Place on the axis, counted in values; between two of them where neither is round. */
  readonly place: number;
  readonly text: string;
}

/** Every so many values: a person counts on in ones, twos, fives and tens. */
const STRIDES = [1, 2, 5, 10, 20, 25, 50, 100, 200, 250, 500, 1000];

/** How many figures a number takes without its trailing zeros: 1 for 500, 3 for 0.125. */
const figuresOf = (value: number): number => Number(value.toPrecision(12)).toExponential().replace(/e.*|[-.]/g, "").length;

/** Numbers in as few figures as tell them apart, at least three. */
export function numberWords(values: readonly number[]): string[] {
  for (let figures = 3; figures < 8; figures += 1) {
    const words = values.map((value) => plain(Number(value.toPrecision(figures))));
    const same = words.some((word, place) => place > 0 && word === words[place - 1]);
    if (!same) return words;
  }
  return values.map(plain);
}

function wordsOf(values: readonly Value[]): string[] {
  const numbers = values.filter((value) => typeof value === "number");
  return numbers.length === values.length ? numberWords(numbers) : values.map(String);
}

const everyOf = <Item>(items: readonly Item[], stride: number, first: number): Item[] => items.filter((_, place) => place % stride === first);

/** The first place from which every `stride`-th value is roundest. */
function roundest(values: readonly Value[], stride: number): number {
  const figures = (first: number): number => {
    const chosen = everyOf(values, stride, first);
    const total = chosen.reduce<number>((sum, value) => sum + (typeof value === "number" && value !== 0 ? figuresOf(value) : 1), 0);
    return total / chosen.length;
  };
  let best = 0;
  for (let first = 1; first < Math.min(stride, values.length); first += 1) if (figures(first) < figures(best) - 1e-9) best = first;
  return best;
}

/** Whether these numbers rise by the same step each time. */
function isEven(numbers: readonly number[]): boolean {
  const step = ((numbers.at(-1) ?? 0) - (numbers[0] ?? 0)) / (numbers.length - 1);
  return step > 0 && numbers.every((value, place) => Math.abs(value - (numbers[0] ?? 0) - place * step) < 1e-3 * step);
}

const isOneTwoOrFive = (value: number): boolean => [1, 2, 5].includes(Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9)));
const isDecade = (value: number): boolean => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;

/** Candidates for round ticks, the denser first; none where values are not spread evenly, by steps or by factors. */
function roundTicks(values: readonly Value[]): { readonly at: (value: number) => number; readonly sets: readonly (readonly number[])[] } | null {
  const numbers = values.filter((value) => typeof value === "number");
  if (numbers.length < values.length || numbers.length < 3) return null;
  const [ends, places] = [[numbers[0] ?? 0, numbers.at(-1) ?? 1], [0, numbers.length - 1]];
  if (isEven(numbers)) {
    const scale = scaleLinear(ends, places);
    return { at: scale, sets: [20, 15, 10, 7, 5, 3, 2].map((count) => scale.ticks(count)) };
  }
  if ((numbers[0] ?? 0) > 0 && isEven(numbers.map(Math.log10))) {
    const scale = scaleLog(ends, places);
    const ticks = scale.ticks(16); // of more it makes linear ones
    return { at: scale, sets: [ticks.filter(isOneTwoOrFive), ticks.filter(isDecade)] };
  }
  return null;
}

/** Whether labels at these places keep clear of each other. */
function isClear(ticks: readonly Tick[], step: number, taken: (text: string) => number): boolean {
  return ticks.every((tick, number) => {
    const before = ticks[number - 1];
    return before === undefined || (tick.place - before.place) * step >= (taken(before.text) + taken(tick.text)) / 2;
  });
}

/** Every so-many-th value, from where these are roundest. */
function valueTicks(values: readonly Value[], stride: number): Tick[] {
  const first = roundest(values, stride);
  const places = everyOf(values.map((_, place) => place), stride, first);
  return wordsOf(places.map((place) => values[place] ?? "")).map((text, number) => ({ place: places[number] ?? 0, text }));
}

/** The labels of an axis whose values stand `step` apart: of all values where there is room, else of round ones.

    `taken` is the room that a label takes along the axis: its width on a level axis, its height on an upright one. */
export function ticksOf(values: readonly Value[], step: number, taken: (text: string) => number): Tick[] {
  const all = valueTicks(values, 1);
  if (isClear(all, step, taken)) return all;
  const round = roundTicks(values);
  for (const set of round?.sets ?? []) {
    const words = numberWords(set);
    const ticks = set.map((value, number) => ({ place: round?.at(value) ?? 0, text: words[number] ?? "" }));
    if (ticks.length > 1 && isClear(ticks, step, taken)) return ticks;
  }
  return STRIDES.map((stride) => valueTicks(values, stride)).find((ticks) => isClear(ticks, step, taken)) ?? [];
}

/** The first of these texts that fits the room; the last one cut short if none does. */
export function fitting(texts: readonly string[], room: number, size: number): string {
  const whole = texts.find((text) => textWidth(text, size) <= room);
  if (whole !== undefined) return whole;
  const last = texts.at(-1) ?? "";
  return `${last.slice(0, Math.max(1, Math.floor(room / (size * LETTER)) - 1))}…`;
}

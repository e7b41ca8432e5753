/** The options of a drop-down, and which of them a key goes to. */

export interface ChoiceOption {
  readonly value: string;
  readonly label: string;
  readonly disabled?: boolean;
}

export const optionsOf = (data: readonly (string | ChoiceOption)[]): ChoiceOption[] =>
  data.map((option) => (typeof option === "string" ? { value: option, label: option } : option));

/** The longest label: a drop-down stays as wide as its widest option. */
export const longestOf = (options: readonly ChoiceOption[]): string =>
  options.reduce((longest, { label }) => (label.length > longest.length ? label : longest), "");

interface Key {
  readonly key: string;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly altKey: boolean;
}

/** The place that Home, End or a letter goes to from that one, as in a native drop-down; null for every other key. */
export function typedTo({ key, ctrlKey, metaKey, altKey }: Key, options: readonly ChoiceOption[], from: number): number | null {
  if (options.length === 0 || ctrlKey || metaKey || altKey) return null;
  if (key === "Home") return 0;
  if (key === "End") return options.length - 1;
  if (key.length !== 1 || key === " ") return null;
  const begins = (place: number): boolean => options[place]?.label.toLowerCase().startsWith(key.toLowerCase()) === true;
  const places = options.map((_, step) => (Math.max(from, -1) + 1 + step) % options.length);
  return places.find((place) => begins(place) && options[place]?.disabled !== true) ?? null;
}

/** At most so many suggestions are shown. */
const SUGGESTIONS = 40;

/** Those that a text is part of, by value or label. */
export function suggestionsFor(text: string, options: readonly ChoiceOption[]): ChoiceOption[] {
  const sought = text.trim().toLowerCase();
  const fits = ({ value, label }: ChoiceOption): boolean => `${value} ${label}`.toLowerCase().includes(sought);
  return options.filter(fits).slice(0, SUGGESTIONS);
}

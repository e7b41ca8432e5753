/** How a number, and a list of numbers, is read from what a person types: one grammar for every field of the page.

    The command line reads by the same grammar (`becalm/typed.py`); `numbers.cases.json` holds both to it. The decimal
    sign is a point. A comma separates the values of a list; where it could be a decimal sign or stand between
    thousands, nothing is guessed. */

export type NumberRead = { readonly value: number } | { readonly error: string };

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const NEEDLESS_ZERO = /^([+-]?)0+(?=\d)/;
const NOT_FINITE = /^[+-]?(inf|infinity|nan)$/i;
/** A comma as the decimal sign: `0,5`, `-1,5e-3`, `,5`. */
const DECIMAL_COMMA = /^[+-]?\d*,\d+(e[+-]?\d+)?$/i;
/** `1,000`, which may be a thousand or one. */
const ONE_GROUP = /^[+-]?[1-9]\d{0,2},\d{3}$/;
/** `1,000,000`, `1,000.5` and `1.000,5`: thousands, as English and as German write them. */
const ENGLISH_THOUSANDS = /^[+-]?\d{1,3}(,\d{3})+(\.\d*)?$/;
const GERMAN_THOUSANDS = /^[+-]?\d{1,3}(\.\d{3})+,\d+$/;

/** What other keyboards and typesetting make of the characters of a number. */
const PLAIN: Readonly<Record<string, string>> = { "＋": "+", "．": ".", "，": ",", "、": ", ", "ｅ": "e", "Ｅ": "E", "…": ".." };
const MINUS_SIGNS = /[\u2010-\u2014\u2212\ufe63\uff0d]/g;

/** The same text in the characters of a plain keyboard: full-width digits and signs, every dash, the ellipsis. */
export function plainly(text: string): string {
  return text
    .replace(MINUS_SIGNS, "-")
    .replace(/[０-９]/g, (digit) => String.fromCharCode(digit.charCodeAt(0) - 0xfee0))
    .replace(/[＋．，、ｅＥ…]/g, (sign) => PLAIN[sign] ?? sign)
    .trim();
}

/** What is wrong with commas in a text that is meant as one number; null if nothing is. */
function aboutCommas(text: string): string | null {
  if (GERMAN_THOUSANDS.test(text)) return `write ${text.replaceAll(".", "").replace(",", ".")}: the decimal sign is a point, and nothing separates thousands`;
  if (ONE_GROUP.test(text)) return `write ${text.replace(",", "")} or ${text.replace(",", ".")}: the decimal sign is a point, and nothing separates thousands`;
  if (DECIMAL_COMMA.test(text)) return `write ${withPoint(text)}: the decimal sign is a point`;
  if (ENGLISH_THOUSANDS.test(text)) return `write ${text.replaceAll(",", "")}: nothing separates thousands`;
  return null;
}

const withPoint = (text: string): string => text.replace(",", ".").replace(/^([+-]?)\./, "$10.");

/** One number, or in words what to write instead. */
export function readNumber(typed: string): NumberRead {
  const text = plainly(typed);
  if (text === "") return { error: "a number is missing" };
  if (NOT_FINITE.test(text)) return { error: `"${text}" is not a finite number` };
  if (!NUMBER.test(text)) return { error: aboutCommas(text) ?? `"${text}" is not a number; write it as 5, 0.5 or 5e-1` };
  if (NEEDLESS_ZERO.test(text)) return { error: `write ${text.replace(NEEDLESS_ZERO, "$1")}, without the zero in front` };
  const value = Number(text);
  if (!Number.isFinite(value)) return { error: `"${text}" is too large` };
  const vanished = value === 0 && /[1-9]/.test(text.split(/e/i)[0] ?? "");
  return vanished ? { error: `"${text}" is too close to zero` } : { value };
}

export type ListRead = { readonly values: readonly (number | string)[] } | { readonly error: string };

const NAME = /^[a-z_][a-z0-9_]*$/i;
/** Narrow and unbreakable spaces stand between thousands, never between the values of a list. */
const THOUSANDS_SPACE = /\d[\u00a0\u2009\u202f']\d/;

/** Whether every comma in a run without spaces can only separate values: a decimal point, a sign or a name beside it says so. */
function commasSeparate(run: string): boolean {
  if (ENGLISH_THOUSANDS.test(run) || GERMAN_THOUSANDS.test(run)) return false;
  const parts = run.split(",");
  return parts.slice(1).every((right, place) => {
    const left = parts[place] ?? "";
    return right === "" || left.includes(".") || right.includes(".") || !/^\d/.test(right) || (left === "" && place > 0);
  });
}

function aboutRun(run: string): string {
  const parts = run.split(",");
  const apart = parts.join(", ");
  const advice = aboutCommas(run);
  if (advice === null) return `"${run}" can be read in two ways; write "${apart}" with a space after each comma, and a point as the decimal sign`;
  const listed = parts.length === 2 && parts.every((part) => "value" in readNumber(part));
  return listed ? `${advice}; for two values write "${apart}"` : advice;
}

/** The values of a list: numbers, or names of choices, separated by spaces or by commas. */
export function readList(typed: string): ListRead {
  if (THOUSANDS_SPACE.test(typed)) return { error: `"${typed.trim()}": nothing separates thousands; separate values by a comma and a space` };
  const text = plainly(typed);
  if (text === "") return { error: "values are missing" };
  if (/,\s*,|^,\s|^,$/.test(text)) return { error: "a value is missing beside a comma" };
  const values: (number | string)[] = [];
  for (const spaced of text.split(/\s+/)) {
    const run = spaced.replace(/,$/, "");
    if (!commasSeparate(run)) return { error: aboutRun(run) };
    for (const word of run.split(",").filter(Boolean)) {
      const read: NumberRead | { value: string } = NAME.test(word) && !NOT_FINITE.test(word) ? { value: word } : readNumber(word);
      if ("error" in read) return read;
      values.push(read.value);
    }
  }
  return oneKind(values);
}

/** Numbers and names do not stand in one list. */
function oneKind(values: readonly (number | string)[]): ListRead {
  const name = values.find((value) => typeof value === "string");
  return name !== undefined && values.some((value) => typeof value === "number") ? { error: `"${name}" is not a number` } : { values };
}

/** One whole number that the page can hold exactly. */
export function readWhole(typed: string): NumberRead {
  const read = readNumber(typed);
  if ("error" in read) return read;
  if (!Number.isInteger(read.value)) return { error: "takes whole numbers" };
  return Number.isSafeInteger(read.value) ? read : { error: `the page holds whole numbers up to ${Number.MAX_SAFE_INTEGER}; a script can set larger ones` };
}

/** Methods by their names in the configuration, as they are read. */

/** Where taking the underscores away is not enough. */
const WORDS: Readonly<Record<string, string>> = { co_moving_couple: "co-moving couple" };

export const methodWords = (name: string): string => WORDS[name] ?? name.replaceAll("_", " ");

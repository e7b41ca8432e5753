/**
 * Which folder of `src` may import which, as rules for eslint's `no-restricted-imports`.
 *
 * A room imports from the rooms before it, never from those after it. Features import from each other only what stands
 * in `FEATURES`, where each may use those before it. STOP imports nothing of the rest (docs/decisions/0007).
 */

/** From the bottom up. `client` is generated; `api` alone knows it. */
const ORDER = ["stop", "ui", "units", "client", "api", "source", "store", "features", "shell"];

/** From the bottom up: each feature, and the features that it may import. */
export const FEATURES = {
  access: [],
  glossary: [],
  control: ["access"],
  mission: ["glossary"],
  events: ["access"],
  alarms: ["access", "control"],
  scene: ["access"],
  runs: ["glossary"],
  lookahead: [],
  commands: ["control", "lookahead", "mission"],
  parameters: ["access", "commands", "control"],
  replay: ["mission", "scene"],
  plots: [],
  rehearsal: ["access", "glossary", "parameters", "plots"],
  link: ["control", "plots"],
  fit: ["access", "rehearsal"],
  library: ["access", "commands", "events", "fit", "glossary", "plots", "rehearsal", "replay", "runs"],
  overlay: ["glossary", "library", "plots"],
  studies: ["access", "commands", "glossary"],
  atlas: ["access", "glossary", "parameters", "rehearsal", "studies"],
};

/** The folders that have files of their own: each feature is one. */
export const ROOMS = [...ORDER.filter((room) => room !== "features" && room !== "client"), ...Object.keys(FEATURES).map((name) => `features/${name}`)];

const alternatives = (names) => `(${names.join("|")})`;

/** @returns patterns of the import paths that files in `src/${room}` may not use. */
export function roomsNotFor(room) {
  const [layer, feature] = room.split("/");
  const place = ORDER.indexOf(layer);
  const later = layer === "stop" ? ORDER.slice(1) : ORDER.slice(place + 1);
  const hidden = layer === "api" ? later : [...later, "client"];
  const patterns = hidden.length === 0 ? [] : [{ regex: `^(\\.\\./)+${alternatives(hidden)}(/|$)`, message: `${room} does not know ${hidden.join(", ")}: import-order.js` }];
  if (feature === undefined) return patterns;
  const known = [feature, ...FEATURES[feature]];
  return [...patterns, { regex: `^(\\.\\./)+(features/)?${alternatives(Object.keys(FEATURES).filter((name) => !known.includes(name)))}/`, message: `features/${feature} imports features/${known.slice(1).join(", ") || "…"} only: import-order.js` }];
}

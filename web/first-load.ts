/** Holds the first load of the console within a bound: a build that is larger fails. */
import { gzipSync } from "node:zlib";
import type { Plugin, Rolldown } from "vite";

type Bundle = Rolldown.OutputBundle;

/** In the name of the font of the first page: its other subsets are read when one of their signs is shown. */
const FONT = "inter-latin-";

/** Of a response: the service sends its security headers with each. */
const HEADERS = 700;

const lengthOf = (source: string | Uint8Array): number => gzipSync(source).length;

/** What a browser asks for before the page is useful: the document, its scripts with all that they import at once, styles, fonts. */
export function firstLoadOf(bundle: Bundle): ReadonlyMap<string, number> {
  const found = new Map<string, number>();
  const visit = (name: string): void => {
    const file = bundle[name];
    if (file === undefined || found.has(name)) return;
    found.set(name, HEADERS + (file.type === "chunk" ? lengthOf(file.code) : lengthOf(file.source)));
    if (file.type !== "chunk") return;
    for (const next of [...file.imports, ...(file.viteMetadata?.importedCss ?? [])]) visit(next);
  };
  for (const [name, file] of Object.entries(bundle)) {
    if (file.type === "chunk" ? file.isEntry : name === "index.html" || name.includes(FONT)) visit(name);
  }
  return found;
}

/** @param bound bytes, compressed */
export function firstLoadWithin(bound: number): Plugin {
  return {
    name: "first-load",
    apply: "build",
    enforce: "post",
    generateBundle: {
      order: "post",
      handler(_, bundle) {
        const files = firstLoadOf(bundle);
        const total = [...files.values()].reduce((sum, size) => sum + size, 0);
        const words = `first load: ${Math.round(total / 1000)} kB compressed, ${files.size} files; at most ${Math.round(bound / 1000)} kB`;
        if (total > bound) this.error(`${words}: ${[...files].map(([name, size]) => `${name} ${size}`).join(", ")}. Have what is not needed at once read later (src/shell/later.tsx).`);
        this.info(words);
      },
    },
  };
}

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import react from "@vitejs/plugin-react";
import { build, defineConfig, type Plugin } from "vite";
import { helpPages } from "./documentation.ts";
import { firstLoadWithin } from "./first-load.ts";

/** Bytes, compressed: on a slow network of a lab the console is there within a few seconds. */
const FIRST_LOAD = 350_000;

const service = process.env["BECALM_URL"] ?? "http://127.0.0.1:8000";

/** The API's own documentation page, `/docs`, loads Swagger UI from here instead of from a CDN, and the console's looks. */
function swaggerUi(): Plugin {
  const folder = dirname(createRequire(import.meta.url).resolve("swagger-ui-dist/package.json"));
  return {
    name: "swagger-ui",
    apply: "build",
    generateBundle() {
      for (const name of ["swagger-ui-bundle.js", "swagger-ui.css"]) {
        this.emitFile({ type: "asset", fileName: `swagger/${name}`, source: readFileSync(join(folder, name)) });
      }
      const looks = ["src/ui/theme/tokens.css", "api-docs.css"].map((name) => readFileSync(name, "utf8")).join("\n");
      this.emitFile({ type: "asset", fileName: "swagger/console.css", source: looks });
    },
  };
}

const STOP_ENTRY = "/src/stop/main.ts";
const STOP_PLACE = "<!-- stop -->";

/** The script and the style of STOP as elements that need no other file. */
async function builtStop(): Promise<string> {
  const built = await build({
    configFile: false,
    logLevel: "error",
    build: { write: false, target: "es2022", lib: { entry: `.${STOP_ENTRY}`, formats: ["iife"], name: "stop", fileName: "stop" } },
  });
  const files = (Array.isArray(built) ? built : [built]).flatMap((result) => ("output" in result ? result.output : []));
  return files
    .map((file) => (file.type === "chunk" ? `<script>${file.code}</script>` : `<style>${String(file.source)}</style>`))
    .join("\n    ");
}

/** STOP stands in `index.html` itself, before every other file: none that is late, or missing, can keep it from the page. */
function stopFirst(): Plugin {
  return {
    name: "stop-first",
    transformIndexHtml: {
      order: "post",
      handler: async (html, { server }) => {
        const elements = server === undefined ? await builtStop() : `<script type="module" src="${STOP_ENTRY}"></script>`;
        if (!html.includes(STOP_PLACE)) throw new Error(`index.html has no ${STOP_PLACE}`);
        return html.replace(STOP_PLACE, () => elements);
      },
    },
  };
}

export default defineConfig({
  plugins: [react(), swaggerUi(), stopFirst(), helpPages("../docs", "help.css"), firstLoadWithin(FIRST_LOAD)],
  // Relative: the console may lie under a path of another site (src/api/address.ts).
  base: "./",
  build: {
    outDir: "../server/static",
    emptyOutDir: true,
    target: "es2022",
    // Fonts stay files of their own: a data: URL would need a wider Content-Security-Policy.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    // jsPDF would read these for HTML and canvas sources; figures are SVG (src/ui/export).
    rolldownOptions: {
      external: ["html2canvas", "dompurify", "canvg"],
      // What the page needs at once is one file: smaller than two dozen, and asked for once.
      output: { codeSplitting: { groups: [{ name: "console", tags: ["$initial"] }] } },
    },
  },
  server: {
    proxy: {
      "/api": { target: service, ws: true },
      "/scene": { target: service, ws: true },
    },
  },
});

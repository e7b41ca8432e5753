import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import react from "@vitejs/plugin-react";
import { defineConfig, type Plugin } from "vite";

const service = process.env["BECALM_URL"] ?? "http://127.0.0.1:8000";

/** The API's own documentation page, `/docs`, loads Swagger UI from here instead of from a CDN. */
function swaggerUi(): Plugin {
  const folder = dirname(createRequire(import.meta.url).resolve("swagger-ui-dist/package.json"));
  return {
    name: "swagger-ui",
    apply: "build",
    generateBundle() {
      for (const name of ["swagger-ui-bundle.js", "swagger-ui.css"]) {
        this.emitFile({ type: "asset", fileName: `swagger/${name}`, source: readFileSync(join(folder, name)) });
      }
    },
  };
}

export default defineConfig({
  plugins: [react(), swaggerUi()],
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
    rolldownOptions: { external: ["html2canvas", "dompurify", "canvg"] },
  },
  server: {
    proxy: {
      "/api": { target: service, ws: true },
      "/scene": { target: service, ws: true },
    },
  },
});

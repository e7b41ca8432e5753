/**
 * The documentation as pages that the service serves under `/help/`, so that help opens at the right place without a
 * network: docs/*.md in the console's looks, equations as MathML. (`make docs` builds the site for the web.)
 */
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { Marked, type Tokens } from "marked";
import temml from "temml";
import type { Plugin } from "vite";

export interface DocumentationFile {
  readonly name: string;
  readonly content: string | Uint8Array;
}

const escaped = (text: string): string => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");

/** A heading's anchor, as the site has it: "Alarms, limits" is `alarms-limits`. */
export const anchorOf = (heading: string): string =>
  heading
    .toLowerCase()
    .replace(/<[^>]*>/g, "")
    .replace(/[^\p{L}\p{N}\s_-]/gu, "")
    .trim()
    .replace(/[\s-]+/g, "-");

/** A link within the documentation leads to its page here; one out of it stays as words. */
export function linkTo(href: string): string | null {
  if (/^(https?:|mailto:|#)/.test(href)) return href;
  const match = /^([\w-]+)\.md(#.*)?$/.exec(href);
  return match === null ? null : `${match[1] ?? ""}.html${match[2] ?? ""}`;
}

const equation = (latex: string, displayMode: boolean): string => temml.renderToString(latex, { displayMode, throwOnError: true });

/** Equations between dollars, as in the site. */
const EQUATIONS = [
  {
    name: "block",
    level: "block" as const,
    start: (text: string) => text.indexOf("$$"),
    tokenizer: (text: string) => {
      const match = /^\$\$([\s\S]+?)\$\$/.exec(text);
      return match === null ? undefined : { type: "block", raw: match[0], latex: match[1] ?? "" };
    },
    renderer: (token: Tokens.Generic) => equation(String(token["latex"]), true),
  },
  {
    name: "inline",
    level: "inline" as const,
    start: (text: string) => text.indexOf("$"),
    tokenizer: (text: string) => {
      const match = /^\$(?!\s)((?:[^$\\\n]|\\.|\n)+?)(?<!\s)\$(?!\d)/.exec(text);
      return match === null ? undefined : { type: "inline", raw: match[0], latex: match[1] ?? "" };
    },
    renderer: (token: Tokens.Generic) => equation(String(token["latex"]), false),
  },
];

function newMarked(): Marked {
  const marked = new Marked({ gfm: true });
  marked.use({
    extensions: EQUATIONS,
    renderer: {
      heading({ tokens, depth, text }) {
        return `<h${depth} id="${anchorOf(text)}">${this.parser.parseInline(tokens)}</h${depth}>\n`;
      },
      link({ href, tokens }) {
        const to = linkTo(href);
        const words = this.parser.parseInline(tokens);
        return to === null ? words : `<a href="${escaped(to)}">${words}</a>`;
      },
      image({ href, text }) {
        return `<img src="${escaped(href)}" alt="${escaped(text)}" loading="lazy">`;
      },
      table(token) {
        const row = (cells: Tokens.TableCell[], cell: "th" | "td"): string => `<tr>${cells.map(({ tokens }) => `<${cell}>${this.parser.parseInline(tokens)}</${cell}>`).join("")}</tr>`;
        return `<div class="table" tabindex="0"><table><thead>${row(token.header, "th")}</thead><tbody>${token.rows.map((cells) => row(cells, "td")).join("")}</tbody></table></div>`;
      },
    },
  });
  return marked;
}

const titleOf = (markdown: string, name: string): string => /^# (.+)$/m.exec(markdown)?.[1] ?? name;

/** In the order in which a newcomer reads. */
const FIRST = ["index", "console", "studies", "rehearsal", "logs", "api", "method", "conventions", "operations", "link", "access"];

const place = (name: string): number => (FIRST.includes(name) ? FIRST.indexOf(name) : FIRST.length);

export interface Source {
  readonly name: string;
  readonly markdown: string;
}

/** Whole pages, each with the way to all others. */
export function pagesOf(sources: readonly Source[]): DocumentationFile[] {
  const marked = newMarked();
  const ordered = [...sources].sort((one, other) => place(one.name) - place(other.name) || one.name.localeCompare(other.name));
  return ordered.map(({ name, markdown }) => {
    const nav = ordered.map((each) => `<a href="${each.name}.html"${each.name === name ? ' aria-current="page"' : ""}>${escaped(titleOf(each.markdown, each.name))}</a>`).join("\n");
    const body = marked.parse(markdown, { async: false });
    return {
      name: `${name}.html`,
      content: `<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="dark light">
<link rel="icon" type="image/svg+xml" href="../favicon.svg"><link rel="stylesheet" href="help.css"><title>${escaped(titleOf(markdown, name))} · Becalm</title></head>
<body><nav aria-label="Documentation"><strong>Becalm</strong>
${nav}
</nav><main>${body}</main></body>
</html>
`,
    };
  });
}

/** Everything of that folder that belongs under `/help/`. @throws Error if it is not there, or an equation cannot be drawn. */
export function documentation(folder: string, style: string): DocumentationFile[] {
  const names = readdirSync(folder);
  const sources = names.filter((name) => name.endsWith(".md")).map((name) => ({ name: name.slice(0, -3), markdown: readFileSync(join(folder, name), "utf8") }));
  const images = readdirSync(join(folder, "images")).map((name) => ({ name: `images/${name}`, content: readFileSync(join(folder, "images", name)) }));
  return [...pagesOf(sources), ...images, { name: "help.css", content: readFileSync(style) }];
}

/** Emits the documentation into the build. */
export function helpPages(folder: string, style: string): Plugin {
  return {
    name: "help-pages",
    apply: "build",
    generateBundle() {
      for (const { name, content } of documentation(folder, style)) this.emitFile({ type: "asset", fileName: `help/${name}`, source: content });
    },
  };
}

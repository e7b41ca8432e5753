import { describe, expect, it } from "vitest";
import { anchorOf, documentation, linkTo, pagesOf } from "../documentation";
import { HELP, PAGE_HELP } from "./shell/help";

const FILES = documentation("../docs", "help.css");
const textOf = (name: string): string => String(FILES.find((file) => file.name === name)?.content ?? "");

describe("the documentation that comes with the service", () => {
  it("has every place that the console leads to", () => {
    for (const topic of [...HELP.map((each) => each.topic), ...Object.values(PAGE_HELP)]) {
      const [page = "", anchor] = topic.split("#");
      expect(textOf(page), topic).toContain("<main>");
      if (anchor !== undefined) expect(textOf(page), topic).toContain(`id="${anchor}"`);
    }
  });

  it("leads nowhere that there is not", () => {
    const names = new Set(FILES.map(({ name }) => name));
    for (const { name, content } of FILES.filter((file) => file.name.endsWith(".html"))) {
      for (const [, to = ""] of String(content).matchAll(/(?:href|src)="([^"#:]+)(?:#[^"]*)?"/g)) {
        if (to !== "../favicon.svg") expect(names.has(to), `${name} leads to ${to}`).toBe(true);
      }
    }
  });

  it("draws equations, and takes markup of the text for text", () => {
    const content = pagesOf([{ name: "a", markdown: "# A & B\n\n$x_b$ is 5 $ or `$HOME`.\n\n$$\nH \\dot x = 0\n$$\n" }])[0]?.content;
    expect(String(content).match(/<math/g)).toHaveLength(2);
    expect(content).toContain("A &amp; B");
    expect(content).toContain("$HOME");
  });

  it("names headings as the site does", () => {
    expect(anchorOf("In the console, and over REST")).toBe("in-the-console-and-over-rest");
    expect(linkTo("studies.md#grids")).toBe("studies.html#grids");
    expect(linkTo("decisions/0007-stop-stands-apart.md")).toBeNull();
    expect(linkTo("../README.md")).toBeNull();
    expect(linkTo("https://example.org/a.md")).toBe("https://example.org/a.md");
  });
});

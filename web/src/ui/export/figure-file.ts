/**
 * Saves a figure as a file for a paper or a report: SVG, PNG or PDF, on white, whatever the page's theme is.
 *
 * A figure is the markup of one `<svg>` that needs nothing of the page: white ground, its own colours, fonts that
 * every viewer has (`FIGURE_FONT`), sizes in its `width` and `height` attributes (CSS pixels).
 */

import type { FigureFormat } from "./formats";
import { saveFile } from "./save-file";

/** One of the fourteen fonts that every PDF reader has; elsewhere what looks like it. */
export const FIGURE_FONT = "Helvetica, Arial, sans-serif";

/** Dots of a PNG for each CSS pixel: about 300 to the inch. */
const PNG_SCALE = 3;
/** PDF points for each CSS pixel. */
const POINTS = 0.75;

/** What `Helvetica` of a PDF has no sign for, in signs that it has. */
const PDF_SIGNS: readonly (readonly [string, string])[] = [
  ["\u2212", "-"],
  ["\u2026", "..."],
  ["\u2192", "to"],
];

export const escaped = (text: string): string =>
  text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");

/** @throws Error if the browser cannot make a file of that format. */
export async function saveFigure(markup: string, name: string, format: FigureFormat): Promise<void> {
  saveFile(await fileOf(markup, format), `${name}.${format}`);
}

function fileOf(markup: string, format: FigureFormat): Promise<Blob> {
  if (format === "png") return pngOf(markup);
  if (format === "pdf") return pdfOf(markup);
  return Promise.resolve(new Blob([`<?xml version="1.0" encoding="UTF-8"?>\n${markup}\n`], { type: "image/svg+xml" }));
}

async function pngOf(markup: string): Promise<Blob> {
  const picture = new Image();
  picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(markup)}`;
  await picture.decode();
  const canvas = document.createElement("canvas");
  canvas.width = Math.round(picture.naturalWidth * PNG_SCALE);
  canvas.height = Math.round(picture.naturalHeight * PNG_SCALE);
  const pen = canvas.getContext("2d");
  if (pen === null) throw new Error("This browser cannot draw images.");
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(picture, 0, 0, canvas.width, canvas.height);
  return new Promise((done, fail) => {
    canvas.toBlob((file) => {
      if (file === null) fail(new Error("This image is too large for the browser."));
      else done(file);
    }, "image/png");
  });
}

async function pdfOf(markup: string): Promise<Blob> {
  // Read when they are first wanted: together they are as large as the rest of the page.
  const [{ jsPDF }, { svg2pdf }] = await Promise.all([import("jspdf"), import("svg2pdf.js")]);
  const text = PDF_SIGNS.reduce((before, [sign, plain]) => before.replaceAll(sign, plain), markup);
  const picture = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  const [width, height] = ["width", "height"].map((side) => Number(picture.getAttribute(side)) * POINTS) as [number, number];
  const orientation = width > height ? "landscape" : "portrait";
  const document = new jsPDF({ unit: "pt", format: [width, height], orientation, compress: true });
  await svg2pdf(picture, document, { x: 0, y: 0, width, height });
  return document.output("blob");
}

/** Stills and films of a replay: which moments, in which size, on which ground, and how they become files. */

export interface Frame {
  readonly width: number;
  readonly height: number;
}

/** Sizes by name, in pixels. */
export const SIZES: Readonly<Record<string, Frame>> = {
  "1280 × 720": { width: 1280, height: 720 },
  "1920 × 1080": { width: 1920, height: 1080 },
  "3840 × 2160": { width: 3840, height: 2160 },
  "1080 × 1080": { width: 1080, height: 1080 },
  "480 × 270": { width: 480, height: 270 },
};

/** What is behind robot and target. */
export const GROUNDS = ["transparent", "night", "white"] as const;
export type Ground = (typeof GROUNDS)[number];

/** Frames a second. */
export const RATES: readonly number[] = [24, 30, 60];

/** Beyond them it is taken for a slip: ten minutes at 60 a second. */
const MOST_FRAMES = 36_000;

export interface FilmPlan {
  /** Mission time, seconds. */
  readonly from: number;
  readonly to: number;
  /** Of mission time, in a second of the film. */
  readonly speed: number;
  /** Frames a second. */
  readonly rate: number;
}

/** The moments of the frames, in mission time; both ends among them. */
export function momentsOf({ from, to, speed, rate }: FilmPlan): readonly number[] {
  const step = speed / rate;
  const count = Math.floor((to - from) / step + 1e-9) + 1;
  return Array.from({ length: Math.min(count, MOST_FRAMES) }, (_, place) => Math.min(to, from + place * step));
}

/** Why a film cannot be made of that; null if it can. */
export function refusalOf({ from, to, speed, rate }: FilmPlan, end: number): string | null {
  if (!(from >= 0 && to > from)) return "The film ends after it begins, and begins at 0 s or later.";
  if (to > end + 1e-9) return `The run ends at ${end.toFixed(3)} s.`;
  return ((to - from) * rate) / speed > MOST_FRAMES ? `A film has at most ${MOST_FRAMES} frames: choose a shorter stretch, a higher speed or fewer frames a second.` : null;
}

/** The colours behind the scene on the page (server/pages/scene_page.py). */
const NIGHT: readonly (readonly [number, string])[] = [
  [0, "#151b24"],
  [0.6, "#0e1116"],
  [1, "#0a0c10"],
];

type Pen = OffscreenCanvasRenderingContext2D;

function fillGround(pen: Pen, { width, height }: Frame, ground: Ground): void {
  pen.clearRect(0, 0, width, height);
  if (ground === "transparent") return;
  if (ground === "night") {
    const shade = pen.createRadialGradient(width / 2, 0.4 * height, 0, width / 2, 0.4 * height, 0.75 * Math.max(width, height));
    for (const [place, colour] of NIGHT) shade.addColorStop(place, colour);
    pen.fillStyle = shade;
  } else pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, width, height);
}

/** What pictures are put on. */
export class Sheet {
  readonly canvas: OffscreenCanvas;
  private readonly pen: Pen;

  /** @throws Error if the browser has none of that size */
  constructor(
    private readonly size: Frame,
    private readonly ground: Ground,
  ) {
    this.canvas = new OffscreenCanvas(size.width, size.height);
    const pen = this.canvas.getContext("2d");
    if (pen === null) throw new Error("This browser cannot draw images.");
    this.pen = pen;
    pen.imageSmoothingQuality = "high";
  }

  /** @param picture of any size: it is made to fill the sheet */
  async put(picture: Blob): Promise<void> {
    const image = await createImageBitmap(picture);
    fillGround(this.pen, this.size, this.ground);
    this.pen.drawImage(image, 0, 0, this.size.width, this.size.height);
    image.close();
  }

  still(): Promise<Blob> {
    return this.canvas.convertToBlob({ type: "image/png" });
  }
}

/** Whether this browser can make films at all. */
export const canFilm = (): boolean => "VideoEncoder" in globalThis;

/**
 * A film, WebM, of the moments of the plan.
 * @param take a picture of a moment
 * @param tell how many of how many frames are done
 * @throws Error in words
 */
export async function filmed(plan: FilmPlan, sheet: Sheet, take: (time: number) => Promise<Blob>, tell: (done: number, total: number) => void): Promise<Blob> {
  // Read when it is first wanted: who never films does not wait for it.
  const { BufferTarget, canEncodeVideo, CanvasSource, Output, QUALITY_HIGH, WebMOutputFormat } = await import("mediabunny");
  const { width, height } = sheet.canvas;
  const codec = (await canEncodeVideo("vp9", { width, height })) ? "vp9" : "vp8";
  const target = new BufferTarget();
  const output = new Output({ format: new WebMOutputFormat(), target });
  const track = new CanvasSource(sheet.canvas, { codec, quality: QUALITY_HIGH });
  output.addVideoTrack(track, { frameRate: plan.rate });
  await output.start();
  try {
    const moments = momentsOf(plan);
    for (const [place, moment] of moments.entries()) {
      await sheet.put(await take(moment));
      await track.add(place / plan.rate, 1 / plan.rate);
      tell(place + 1, moments.length);
    }
    await output.finalize();
  } catch (cause) {
    await output.cancel();
    throw cause;
  }
  if (target.buffer === null) throw new Error("The film is empty.");
  return new Blob([target.buffer], { type: "video/webm" });
}

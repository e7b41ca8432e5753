/** How finely scenes are drawn in this browser. */
import { useKept } from "../../ui/use-kept";

/** `light` draws a quarter of the pixels, without environment map and shadows. */
export type Detail = "full" | "light";

/** What draws in software: names by which renderers without a graphics card go. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|microsoft basic render/i;

export const isSoftware = (renderer: string): boolean => SOFTWARE.test(renderer);

/** What draws three dimensions in this browser; empty if it does not say. */
function rendererOf(): string {
  try {
    const context = document.createElement("canvas").getContext("webgl2");
    if (context === null) return "";
    const names = context.getExtension("WEBGL_debug_renderer_info");
    const renderer: unknown = context.getParameter(names === null ? context.RENDERER : names.UNMASKED_RENDERER_WEBGL);
    context.getExtension("WEBGL_lose_context")?.loseContext();
    return typeof renderer === "string" ? renderer : "";
  } catch {
    return "";
  }
}

let usual: Detail | null = null;

/** What suits this computer; looked up once. */
function usualDetail(): Detail {
  usual ??= isSoftware(rendererOf()) ? "light" : "full";
  return usual;
}

export const sceneAddress = (scene: string, detail: Detail): string => scene + (detail === "light" ? "?light" : "");

export interface DetailChoice {
  readonly detail: Detail;
  readonly choose: (detail: Detail) => void;
  /** Whether nobody chose it: it follows from what draws here. */
  readonly byItself: boolean;
}

/** The choice of a person is kept and wins; without one the scene is light where software draws it. */
export function useDetail(): DetailChoice {
  const [kept, choose] = useKept<Detail | "usual">("becalm-scene", "usual", ["usual", "full", "light"]);
  return { detail: kept === "usual" ? usualDetail() : kept, choose, byItself: kept === "usual" };
}

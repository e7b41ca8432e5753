/** How finely scenes are drawn in this browser. */
import { addressOf } from "../../api/address";
import { useKept } from "../../app/preferences";

/** `light` draws a quarter of the pixels. */
export type Detail = "full" | "light";

export const sceneAddress = (scene: `/${string}`, detail: Detail): string =>
  addressOf(scene) + (detail === "light" ? "?fixedDpr=0.5" : "");

export function useDetail(): { readonly detail: Detail; readonly choose: (detail: Detail) => void } {
  const [detail, choose] = useKept<Detail>("becalm-scene", "full", ["full", "light"]);
  return { detail, choose };
}

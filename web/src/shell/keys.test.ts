import { describe, expect, it } from "vitest";
import { keyMeaning } from "./keys";

const key = (text: string, more: object = {}) => ({ key: text, ctrlKey: false, metaKey: false, altKey: false, target: null, ...more });
const INPUT = { tagName: "INPUT" } as unknown as EventTarget;

describe("the keys of the whole page", () => {
  it("open the palette, also while somebody types", () => {
    expect(keyMeaning(key("k", { ctrlKey: true, target: INPUT }), false)).toBe("palette");
    expect(keyMeaning(key("K", { metaKey: true }), false)).toBe("palette");
    expect(keyMeaning(key("k"), false)).toBeNull();
  });

  it("lead to a page after a g, and only then", () => {
    expect(keyMeaning(key("g"), false)).toBe("chord");
    expect(keyMeaning(key("w"), true)).toEqual({ page: "alarms" });
    expect(keyMeaning(key("w"), false)).toBeNull();
  });

  it("are text where somebody types", () => {
    expect(keyMeaning(key("?"), false)).toBe("sheet");
    expect(keyMeaning(key("?", { target: INPUT }), false)).toBeNull();
    expect(keyMeaning(key("g", { target: INPUT }), false)).toBeNull();
  });

  it("leave Esc to STOP", () => {
    expect(keyMeaning(key("Escape"), true)).toBeNull();
  });
});

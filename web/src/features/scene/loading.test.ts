import { describe, expect, it } from "vitest";
import { isSoftware } from "./detail";
import { loadingWords, stageIn } from "./loading";

describe("a scene on its way", () => {
  it("says what is awaited until it is drawn", () => {
    expect(loadingWords("waiting", "full")).toBe("Loading the scene: 0.8 MB, once per browser.");
    expect(loadingWords("begun", "full")).toMatch(/the light scene is quicker/);
    expect(loadingWords("begun", "light")).toBe("Loading the scene: drawing robot and target for the first time.");
    expect(loadingWords("drawn", "full")).toBeNull();
  });

  it("is told by messages of its own only", () => {
    expect(stageIn({ scene: "drawn" })).toBe("drawn");
    for (const other of [null, "drawn", { scene: "other" }, { stage: "drawn" }, undefined, 1]) expect(stageIn(other)).toBeNull();
  });
});

it("what draws in software is known by its name", () => {
  for (const name of ["ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader driver)", "llvmpipe (LLVM 17.0.6, 256 bits)", "Microsoft Basic Render Driver", "Mesa softpipe"]) expect(isSoftware(name)).toBe(true);
  for (const name of ["ANGLE (NVIDIA GeForce RTX 4070)", "Mesa Intel(R) UHD Graphics 620 (KBL GT2)", "Apple M2", ""]) expect(isSoftware(name)).toBe(false);
});

"""How soon a scene can be seen: `python -m benchmarks.scene`.

A real service and Chromium beside it: from the opening of the console to the first picture with robot and target, with
an empty cache, again with the page kept by the browser, and for the light scene as for the full one. Without a
graphics card Chromium draws in software; what it draws with is printed. Every wait is bounded (`--patience`).
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.browsers import CHROMIUM, FLAGS
from benchmarks.service import Figures, Running, service, told

LISTEN = """
if (window === top) {
  window.stages = {};
  addEventListener("message", ({ data }) => {
    if (data && data.scene) window.stages[data.scene] ??= performance.now();
  });
  localStorage.setItem("becalm-scene", "%s");
}
"""
"""Notes when the scene tells how far it is (server/pages/scene_page.py)."""

LOOK_PERIOD = 100
"""Between two looks whether a picture has come [ms]; when it came, the page itself notes."""

RENDERER = """() => {
  const context = document.createElement("canvas").getContext("webgl2");
  const names = context.getExtension("WEBGL_debug_renderer_info");
  return context.getParameter(names === null ? context.RENDERER : names.UNMASKED_RENDERER_WEBGL);
}"""


def seen_after(page: Page, running: Running, patience: float) -> dict[str, float]:
    """When each stage came, after the page was asked for [s]; those that did not come within `patience` [s] are out."""
    until = time.monotonic() + patience
    page.goto(f"http://127.0.0.1:{running.port}/", timeout=1e3 * patience, wait_until="commit")
    stages: dict[str, float] = {}
    # Looked for from outside: the page's own policy lets nobody wait for an expression within it.
    while "drawn" not in stages and time.monotonic() < until:
        page.wait_for_timeout(LOOK_PERIOD)
        stages = page.evaluate("window.stages")
    return {stage: at / 1e3 for stage, at in stages.items()}


def measured(browser: Browser, running: Running, detail: str, tries: int, patience: float) -> Figures:
    """Medians over so many browsers with empty caches, each opening the console twice; none where no picture came."""
    first, second = [], []
    for _ in range(tries):
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        context.add_init_script(LISTEN % detail)
        page = context.new_page()
        first.append(seen_after(page, running, patience))
        second.append(seen_after(page, running, patience))
        context.close()
        if "drawn" not in first[-1] or "drawn" not in second[-1]:
            print(f"{detail}: no picture within {patience:g} s; it came as far as {first[-1]}", file=sys.stderr)
            break
    again = _medians(f"{detail}: {{}}, page kept, s", [{"drawn": each["drawn"]} for each in second if "drawn" in each])
    return _medians(f"{detail}: {{}}, s", first) | again


def _medians(label: str, tries: list[dict[str, float]]) -> Figures:
    """Of the stages that came in every try."""
    common = [stage for stage in (tries[0] if tries else ()) if all(stage in each for each in tries)]
    return {label.format(stage): float(np.median([each[stage] for each in tries])) for stage in common}


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--tries", type=int, default=3)
    parser.add_argument("--patience", type=float, default=120.0, help="for one picture [s]")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as name,
        service(Path(name)) as running,
        sync_playwright() as playwright,
        playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS)) as browser,
    ):
        page = browser.new_page()
        print(f"drawn by {page.evaluate(RENDERER)}", file=sys.stderr)
        page.close()
        figures: Figures = {}
        for detail in ("light", "full"):
            figures |= measured(browser, running, detail, arguments.tries, arguments.patience)
    return told(figures, as_json=arguments.json)


if __name__ == "__main__":
    sys.exit(main())

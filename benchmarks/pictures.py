"""The pictures of the console in README and documentation: `python -m benchmarks.pictures docs/images`; some minutes.

A real service with captures, a study, a rehearsal and an atlas of its own, and one Chromium that looks at it. `--only
console atlas` draws some of them. The picture of the link's page needs a robot, and is not among them.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import httpx
from PIL import Image
from playwright.sync_api import Browser, Locator, Page, ViewportSize, sync_playwright

from benchmarks.browsers import CHROMIUM, FLAGS, PATIENCE
from benchmarks.service import Running, command, service

VIEWPORT: ViewportSize = {"width": 1440, "height": 900}
SLOWLY = 0.2
"""How fast the mission goes until the picture of a capture, in multiples of real time: a busy machine is in time."""

BANNER = (1420, 70)
"""A pixel that is red while data are old."""

TRIES = 20
"""A page that software draws may be held up; data that are old are grey."""

RUN = {"configuration": "becalm", "changes": {"target": {"initial_spin": 1.4}}}
"""The run that is shown; others stand beside it."""
OTHERS: tuple[dict[str, Any], ...] = (
    {"configuration": "published"},
    {"configuration": "published", "direct": True},
    {"configuration": "becalm", "seed": 3},
    {"configuration": "as_printed"},
)
SHOWN_AT = 2.4
"""Mission time of its replay [s]."""

FAST = {"simulation": {"engine": "reduced"}}


def _asked(running: Running, path: str, body: dict[str, Any]) -> Any:
    answer = httpx.post(running.api + path, json=body, timeout=60)
    answer.raise_for_status()
    return answer.json()


def _until(holds: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + PATIENCE / 1000
    while not holds():
        if time.monotonic() > deadline:
            raise TimeoutError(what)
        time.sleep(0.02)


def _page(browser: Browser, running: Running, address: str) -> Page:
    """The console at that address, in the dark theme, its data live."""
    context = browser.new_context(viewport=VIEWPORT)
    context.set_default_timeout(PATIENCE)
    context.add_init_script("localStorage.setItem('becalm-scene', 'light')")
    page = context.new_page()
    page.goto(f"http://127.0.0.1:{running.port}/{address}")
    page.get_by_role("status", name="Data: Live").wait_for()
    return page


def _seen(page: Page) -> None:
    """Wait until the scene that is shown has been drawn."""
    page.locator("iframe:visible").first.wait_for()
    page.get_by_text("Loading the scene").locator("visible=true").first.wait_for(state="hidden")


def _beginning(running: Running, speed: float = 1.0) -> None:
    """A mission at rest that runs."""
    command(running, "reset")
    _asked(running, "/mission/commands", {"command": "run", "speed": speed})


def _both_touch(running: Running) -> bool:
    return len(httpx.get(running.api + "/mission", timeout=30).json()["contacts"]) > 1


def console(browser: Browser, running: Running) -> Page:
    """A capture by our own method, both hands on the target."""
    _beginning(running, SLOWLY)
    page = _page(browser, running, "#/mission")
    _seen(page)
    command(running, "capture")
    _until(lambda: _both_touch(running), "the touch")
    command(running, "pause")
    page.get_by_role("button", name="Run", exact=True).wait_for()
    return page


def rehearsal(browser: Browser, running: Running) -> Page:
    """A hundred futures of a capture before it begins."""
    _beginning(running)
    page = _page(browser, running, "#/mission")
    _seen(page)
    page.get_by_role("button", name="Rehearse", exact=True).first.click()
    page.get_by_role("button", name="Dismiss the rehearsal").wait_for()
    command(running, "pause")
    page.get_by_text("The clock runs late").wait_for(state="hidden")
    return page


def atlas(browser: Browser, running: Running) -> Page:
    """What two parameters would do from here."""
    _beginning(running)
    page = _page(browser, running, "#/atlas")
    page.get_by_role("button", name="Map", exact=True).click()
    flying = page.get_by_role("main").get_by_role("button", name="Cancel", exact=True)
    flying.wait_for()
    flying.wait_for(state="hidden", timeout=3 * PATIENCE)
    page.get_by_role("main").get_by_role("combobox").filter(has_text="outcome").click()
    page.get_by_role("option", name="peak tip force").first.click()
    return page


def runs(browser: Browser, running: Running) -> Page:
    """A run of the library, replayed."""
    for other in OTHERS:
        _finished(running, other | {"changes": FAST})
    run = _finished(running, RUN)
    page = _page(browser, running, f"#/runs/{run}?t={SHOWN_AT}")
    page.get_by_label("At this moment").get_by_text("No data yet.").wait_for(state="hidden")
    _seen(page)
    return page


def _finished(running: Running, request: dict[str, Any]) -> str:
    run = str(_asked(running, "/runs", request)["id"])
    _until(lambda: httpx.get(f"{running.api}/runs/{run}").json()["status"] == "finished", f"run {run}")
    return run


def studies(browser: Browser, running: Running) -> Page:
    """The paper's study, beside what the paper has."""
    study = _asked(running, "/studies", {"study": "published"})["id"]
    page = _page(browser, running, f"#/studies/{study}")
    page.get_by_text("finished, 484 of 484 cells").first.wait_for(timeout=3 * PATIENCE)
    return page


def alarms(browser: Browser, running: Running) -> Page:
    """A spin beyond its limit, and a word to the next shift."""
    _beginning(running)
    page = _page(browser, running, "#/alarms")
    limits = page.get_by_role("region", name="Limits of the signals")
    for level, value in {"watch": "0.5", "warning": "0.9", "critical": ""}.items():
        limits.get_by_label(f"Spin of the target: {level}").fill(value)
    limits.get_by_role("button", name="Save").click()
    page.get_by_label("A note for the next shift").fill("Floor levelled; spin starts at 1 rad/s.")
    page.get_by_role("button", name="Note", exact=True).click()
    named: Locator = page.get_by_role("list", name="Alarms").get_by_text("Spin of the target")
    named.wait_for()
    return page


PICTURES: dict[str, Callable[[Browser, Running], Page]] = {
    picture.__name__: picture for picture in (console, rehearsal, atlas, runs, studies, alarms)
}


def _shoot(page: Page, path: Path) -> None:
    """Take the picture while the data are live."""
    live = page.get_by_role("status", name="Data: Live")
    for _ in range(TRIES):
        live.wait_for()
        page.wait_for_timeout(1000)
        page.screenshot(path=path, animations="disabled")
        with Image.open(path) as picture:
            drawn = picture.convert("RGB")
        red, green, _ = cast("tuple[int, int, int]", drawn.getpixel(BANNER))
        if red < 2 * green:
            drawn.save(path, optimize=True)
            return
    raise TimeoutError(f"the page's data were old at every look for {path.name}")


def drawn(folder: Path, names: list[str]) -> None:
    """Draw those pictures into that folder, each on a page of its own."""
    with tempfile.TemporaryDirectory() as data, service(Path(data)) as running, sync_playwright() as player:
        browser = player.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        for name in names:
            page = PICTURES[name](browser, running)
            path = folder / f"{name}.png"
            _shoot(page, path)
            page.context.close()
            print(path)
        browser.close()


def main() -> int:
    """Draw them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="+", choices=list(PICTURES), default=list(PICTURES))
    arguments = parser.parse_args()
    drawn(arguments.folder, arguments.only)
    return 0


if __name__ == "__main__":
    sys.exit(main())

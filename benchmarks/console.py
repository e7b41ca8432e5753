"""What the console costs a browser: `python -m benchmarks.console`; about a minute, more where software draws.

A real service, and one Chromium at its mission page without the scene: bytes of the first load as they are sent, the
time until data are live and until a command can be pressed, how much of the main thread is taken while the mission is
idle, while a capture is flown with four plots, and while the page is hidden.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from playwright.sync_api import Browser, CDPSession, Page, sync_playwright

from benchmarks.browsers import CHROMIUM, FLAGS, PATIENCE
from benchmarks.service import Running, command, service

KILOBYTES = 350.0
"""To reach: first load, compressed [kB]."""

USEFUL, PRESSABLE = 2.0, 2.5
"""To reach on a quiet machine of two cores: from the request of the page to live data, and to a command [s]."""

IDLE, CAPTURE, HIDDEN = 0.10, 0.25, 0.01
"""To reach: share of the main thread."""

AHEAD = 3.5
"""Until the page reads what is not needed at first [s]."""

WIDE = {"width": 1920, "height": 1080}
"""Four plots are shown."""


class Load(NamedTuple):
    """What the first load of the page took."""

    kilobytes: float
    files: int
    useful: float
    """Until data were live [s]."""
    pressable: float
    """Until Capture could be pressed [s]."""


def _page(browser: Browser) -> tuple[Page, CDPSession]:
    context = browser.new_context(viewport=WIDE)
    context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><title>none</title>"))
    page = context.new_page()
    return page, context.new_cdp_session(page)


def loaded(page: Page, session: CDPSession, running: Running) -> Load:
    """Open the page with nothing kept, and count what comes of its own files until everything needed is there."""
    sizes: dict[str, float] = {}
    own: set[str] = set()

    def requested(event: dict[str, Any]) -> None:
        url = event["request"]["url"]
        if "/api/" not in url and "/scene/" not in url:
            own.add(event["requestId"])

    session.on("Network.requestWillBeSent", requested)
    session.on("Network.loadingFinished", lambda event: sizes.update({event["requestId"]: event["encodedDataLength"]}))
    session.send("Network.enable")
    began = time.monotonic()
    page.goto(f"http://127.0.0.1:{running.port}/", timeout=PATIENCE)
    page.get_by_role("status", name="Data: Live").wait_for(timeout=PATIENCE)
    useful = time.monotonic() - began
    page.locator("button[aria-label='Capture'][aria-disabled='false']").wait_for(timeout=PATIENCE)
    pressable = time.monotonic() - began
    page.wait_for_timeout(max(0.0, AHEAD - pressable) * 1000)
    first = {request: size for request, size in sizes.items() if request in own}
    return Load(sum(first.values()) / 1000, len(first), useful, pressable)


def busy(session: CDPSession, page: Page, seconds: float) -> float:
    """Share of the main thread that was taken for that long."""

    def taken() -> float:
        metrics = session.send("Performance.getMetrics")["metrics"]
        return float(next(each["value"] for each in metrics if each["name"] == "TaskDuration"))

    before, began = taken(), time.monotonic()
    page.wait_for_timeout(1000 * seconds)
    return (taken() - before) / (time.monotonic() - began)


def shares(running: Running, page: Page, session: CDPSession, seconds: float) -> dict[str, float]:
    """Share of the main thread while idle, in a capture, and while another tab is in front.

    By its processor time: by the clock, a machine that does other things would make every task longer.
    """
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    command(running, "reset")
    page.wait_for_timeout(2000)
    found = {"idle": busy(session, page, seconds)}
    command(running, "capture")
    found["in a capture"] = busy(session, page, seconds)
    other = page.context.new_page()
    other.bring_to_front()
    session.send("Emulation.setFocusEmulationEnabled", {"enabled": False})
    # A browser without a window may show every tab at once: there is nothing to measure then.
    if page.evaluate("document.hidden"):
        found["hidden"] = busy(session, other, seconds)
    other.close()
    return found


def told(words: str, value: float, bound: float, form: Callable[[float], str]) -> bool:
    """Say a figure beside what it should be."""
    good = value <= bound
    print(f"{words:<44} {form(value):>9}   (at most {form(bound)}){'' if good else '   NOT REACHED'}")
    return good


def measure(seconds: float) -> bool:
    """All of it; whether every figure was reached."""
    with tempfile.TemporaryDirectory() as folder, service(Path(folder)) as running, sync_playwright() as player:
        browser = player.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        page, session = _page(browser)
        load = loaded(page, session, running)
        found = shares(running, page, session, seconds)
        browser.close()
    print(f"{load.files} files in the first load")
    reached = [
        told("first load, compressed, without the scene", load.kilobytes, KILOBYTES, lambda value: f"{value:.0f} kB"),
        told("until data are live", load.useful, USEFUL, lambda value: f"{value:.2f} s"),
        told("until a command can be pressed", load.pressable, PRESSABLE, lambda value: f"{value:.2f} s"),
    ]
    bounds = {"idle": IDLE, "in a capture": CAPTURE, "hidden": HIDDEN}
    reached += [
        told(f"main thread, {name}", share, bounds[name], lambda value: f"{100 * value:.1f} %")
        for name, share in found.items()
    ]
    return all(reached)


def main() -> int:
    """Measure and print; exit code 1 if a figure is not reached."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0, help="each share is taken over so long")
    arguments = parser.parse_args()
    return 0 if measure(arguments.seconds) else 1


if __name__ == "__main__":
    sys.exit(main())

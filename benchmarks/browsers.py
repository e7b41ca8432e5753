"""What ten real browsers cost the mission: `python -m benchmarks.browsers --minutes 10`.

A real service, and Chromium windows at its console beside it on the same machine: lateness of ticks without them and
with them, each watched for as long, and the time from a command to its answer, once a second. `--realtime` runs the
service before everything else, as a lab would whose mission computer also shows a console. Without a graphics card a
scene is drawn in software, and ten would need ten computers, so `--scenes` says how many of the windows have one.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.service import Figures, Running, command, later_than, service, told

CHROMIUM = "/usr/bin/chromium"
FLAGS = ("--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync")
COUNT = """
localStorage.setItem("becalm-scene", "light");
window.snapshots = 0;
window.WebSocket = class extends WebSocket {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", ({ data }) => {
      window.snapshots += String(data).startsWith('{"type":"snapshot"');
    });
  }
};
"""
"""Counts the snapshots that a page gets."""
PATIENCE = 120_000
"""For a page to be live [ms]."""
BOUNDS = ("0.002", "0.005", "0.01", "0.05", "0.1")
"""Of lateness [s]; buckets of the service's own histogram."""
PAUSE = 1.0
"""Between two commands [s]."""


@contextmanager
def windows(browser: Browser, running: Running, count: int, scenes: int) -> Iterator[list[Page]]:
    """So many consoles, all live; the first of them with a scene."""
    contexts = [browser.new_context(viewport={"width": 1440, "height": 900}) for _ in range(count)]
    pages = []
    for number, context in enumerate(contexts):
        context.add_init_script(COUNT)
        if number >= scenes:
            context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><title>none</title>"))
        pages.append(context.new_page())
    for page in pages:
        page.goto(f"http://127.0.0.1:{running.port}/", timeout=PATIENCE)
    for page in pages:
        page.get_by_role("status", name="Data: Live").wait_for(timeout=PATIENCE)
    yield pages
    for context in contexts:
        context.close()


def watched(running: Running, duration: float, pages: list[Page]) -> Figures:
    """Captures one after another for that long [s]: how late ticks come, how soon commands are answered."""
    with httpx.Client(base_url=running.api, timeout=60) as client:
        return _watched(running, client, duration, pages)


def _watched(running: Running, client: httpx.Client, duration: float, pages: list[Page]) -> Figures:
    command(running, "reset")
    command(running, "capture")
    shown = [int(page.evaluate("window.snapshots")) for page in pages]
    before, began, answers = running.samples(), time.monotonic(), []
    while time.monotonic() - began < duration:
        asked = time.monotonic()
        client.post("/mission/commands", json={"command": "run"}).raise_for_status()
        answers.append(time.monotonic() - asked)
        if client.get("/mission").json()["outcome"] is not None:
            command(running, "reset")
            command(running, "capture")
        time.sleep(PAUSE)
    elapsed, after = time.monotonic() - began, running.samples()
    who = f"{len(pages)} browsers"
    figures = {f"{who}: turns later than {1e3 * float(each):g} ms": later_than(before, after, each) for each in BOUNDS}
    figures[f"{who}: command answered, median, ms"] = 1e3 * float(np.median(answers))
    figures[f"{who}: command answered, 99 %, ms"] = 1e3 * float(np.quantile(answers, 0.99))
    spent = after["process_cpu_seconds_total",] - before["process_cpu_seconds_total",]
    figures[f"{who}: processor time of the service, of one core"] = spent / elapsed
    if pages:
        got = [int(page.evaluate("window.snapshots")) - one for page, one in zip(pages, shown, strict=True)]
        figures[f"{who}: snapshots a second, the slowest"] = min(got) / elapsed
        figures[f"{who}: snapshots a second, the quickest"] = max(got) / elapsed
    return figures


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=2.0, help="with no browser, and again with them")
    parser.add_argument("--browsers", type=int, default=10)
    parser.add_argument("--realtime", action="store_true", help="the service; takes the right to it")
    parser.add_argument("--scenes", type=int, default=1, help="how many of them show the scene, drawn in software")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    duration, options = 60 * arguments.minutes, ["--realtime"] if arguments.realtime else []
    with (
        tempfile.TemporaryDirectory() as name,
        service(Path(name), *options) as running,
        sync_playwright() as playwright,
        playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS)) as browser,
    ):
        figures = watched(running, duration, [])
        with windows(browser, running, arguments.browsers, arguments.scenes) as pages:
            figures |= watched(running, duration, pages)
    return told(figures, as_json=arguments.json)


if __name__ == "__main__":
    sys.exit(main())

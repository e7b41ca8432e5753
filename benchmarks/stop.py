"""How soon STOP is obeyed, whatever others do: `python -m benchmarks.stop`; some minutes, bounded.

A real service flies one capture after another, and is stopped in the middle of each, while a load of
`benchmarks.loads` runs in a process of its own. Obeyed is when the mission thread has stopped, by the mission's own
record; from then on the commanded joint rates are zero. Figures are relative to the bound, 0.2 s.

With `--link` the plant is an emulated robot in a process of its own, and obeyed is when *it* says that it follows no
more commands; it is asked again and again, so a figure is up to a request's time too long.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

import httpx
import numpy as np

from benchmarks.link import Pair, pair
from benchmarks.loads import LOADS, PATIENCE, client, library, under
from benchmarks.service import Figures, Running, service
from server.link.contract import RobotMode

BOUND = 0.2
"""Within which STOP is obeyed [s]."""

SETTLE = 1.0
"""How long a load works before the first try [s]."""


class Try(NamedTuple):
    """One STOP."""

    obeyed_after: float
    """From sending it to the mission's own record of it [s]."""
    answered_after: float
    """[s]"""


def stops(running: Running, folder: Path, tries: int) -> list[Try]:
    """STOP a capture that flies, so many times."""
    found = []
    with client(running.port) as http:
        for number in range(tries):
            command(http, "reset")
            command(http, "capture")
            time.sleep(0.05 + 0.03 * (number % 7))
            found.append(stop(http, folder))
    return found


def command(http: httpx.Client, name: str) -> None:
    """Give the live mission a command, and again if there is no room for it now."""
    until = time.monotonic() + PATIENCE
    while (answer := http.post("/mission/commands", json={"command": name})).status_code != 200:
        if time.monotonic() > until:
            answer.raise_for_status()
        time.sleep(0.05)


def stop(http: httpx.Client, folder: Path) -> Try:
    """Send one, and find it in the record of the mission."""
    sent, began = time.time(), time.monotonic()
    answer = http.post("/mission/stop")
    answered = time.monotonic() - began
    # The mission obeys also one that the answer was too slow for; its record is written within a second.
    obeyed = _recorded(folder, sent, time.monotonic() + PATIENCE)
    assert answer.status_code in (200, 504), answer.text
    return Try(obeyed - sent, answered)


def link_stops(tries: int) -> list[Try]:
    """STOP a capture of an emulated robot, so many times."""
    found = []
    with pair([], [], []) as both:
        for number in range(tries):
            both.begin()
            time.sleep(0.3 + 0.05 * (number % 7))
            found.append(_link_stop(both))
    return found


def _link_stop(both: Pair) -> Try:
    """Send one, and ask the robot until it has obeyed."""
    assert both.robot.get("/status").json()["mode"] == RobotMode.FOLLOWING
    with ThreadPoolExecutor(1) as answering:
        began = time.monotonic()
        answer = answering.submit(_answered_at, both)
        while both.robot.get("/status").json()["mode"] == RobotMode.FOLLOWING:
            if time.monotonic() > began + PATIENCE:
                raise AssertionError("STOP was never obeyed")
        obeyed = time.monotonic()
        return Try(obeyed - began, answer.result() - began)


def _answered_at(both: Pair) -> float:
    both.console.post("/api/v1/mission/stop").raise_for_status()
    return time.monotonic()


def _recorded(folder: Path, sent: float, until: float) -> float:
    while time.monotonic() < until:
        latest = max((folder / "runs").glob("*/run.json"), key=lambda path: path.parent.name).parent
        for line in reversed((latest / "events.jsonl").read_text().splitlines()):
            event = json.loads(line)
            at = datetime.fromisoformat(event["at"]).timestamp()
            if event.get("command") == "stop" and at >= sent - 0.002:  # it is kept to the millisecond
                return at
        time.sleep(0.02)
    raise AssertionError("STOP was never obeyed")


@contextmanager
def busy(processes: int) -> Iterator[None]:
    """So many processes that do nothing but work."""
    running = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes)]
    try:
        yield
    finally:
        for each in running:
            each.kill()
            each.wait()


def figures_of(tries: list[Try]) -> Figures:
    """Percentiles, and the share of the bound."""
    obeyed, answered = np.array(tries).T
    return {
        "obeyed, median, ms": 1e3 * float(np.median(obeyed)),
        "obeyed, 99 %, ms": 1e3 * float(np.quantile(obeyed, 0.99)),
        "obeyed, 99 %, of the 0.2 s": float(np.quantile(obeyed, 0.99)) / BOUND,
        "answered, 99 %, ms": 1e3 * float(np.quantile(answered, 0.99)),
    }


def late_share(before: dict[tuple[str, ...], float], after: dict[tuple[str, ...], float], bound: str) -> float:
    """Share of turns whose oldest tick was later than `bound` [s]."""
    name = "becalm_tick_lateness_seconds_bucket"
    turns, within = (after[name, each] - before[name, each] for each in ("+Inf", bound))
    return 1.0 - within / turns if turns else float("nan")


def measured(names: list[str], tries: int, busy_processes: int, options: list[str]) -> dict[str, Figures]:
    """A table for each load."""
    tables: dict[str, Figures] = {}
    with tempfile.TemporaryDirectory() as name, busy(busy_processes):
        folder = Path(name)
        run_id = library(folder)
        with service(folder, *options) as running:
            for load in names:
                before = running.samples()
                with under(load, running.port, run_id, 2 * PATIENCE + 2.0 * tries):
                    time.sleep(SETTLE)
                    tables[load] = figures_of(stops(running, folder, tries))
                after = running.samples()
                tables[load]["turns later than 5 ms"] = late_share(before, after, "0.005")
                tables[load]["memory, MB"] = 1e-6 * after["process_resident_memory_bytes",]
                print(load, tables[load], file=sys.stderr)
    return tables


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--loads", default=",".join(LOADS), help="which, separated by commas")
    parser.add_argument("--tries", type=int, default=100, help="STOPs under each")
    parser.add_argument("--busy", type=int, default=0, help="processes that keep the cores busy meanwhile")
    parser.add_argument("--link", action="store_true", help="an emulated robot, and no load but --busy")
    parser.add_argument("--port", default="0")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    if arguments.link:
        with busy(arguments.busy):
            tables = {"link": figures_of(link_stops(arguments.tries))}
    else:
        tables = measured(arguments.loads.split(","), arguments.tries, arguments.busy, ["--port", arguments.port])
    if arguments.json:
        print(json.dumps(tables, indent=2))
        return 0
    for title, figures in tables.items():
        print(f"\n{title}")
        for label, value in figures.items():
            print(f"  {value:10.4g}  {label}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

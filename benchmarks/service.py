"""How the running service behaves under load: `python -m benchmarks.service`; about two minutes.

A real service in a process of its own, and its readers in another. Figures are ratios and invariants, so that those
of different machines compare: lateness relative to the 5 ms of mission.md, snapshots received relative to those
asked for, rates relative to real time.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import httpx
import numpy as np
import psutil
import viser
from prometheus_client.parser import text_string_to_metric_families
from websockets.asyncio.client import connect
from websockets.typing import Subprotocol

from sim.capture.mission import prepare
from sim.capture.run import run_capture
from sim.configurations import named_configuration

FIRST_PAGE_FIGURE = 3.0
"""From the command to the first page [s]."""

RATE = 60.0
"""Snapshots a second that each reader asks for."""

CLIENTS = (1, 10, 30, 100)
WATCHED = 8.0
"""Wall time for each number of clients [s]."""

SETTLING = 8.0
"""Wall time that a service is left alone with what it loads in the background after its start [s]."""

FLOWN = 6.0
"""Of a capture, while the cost of it is measured: it moves as long [s]."""

IDLE_FIGURE, READER_FIGURE, SCENE_FIGURE = 0.05, 10.0, 15.0
"""To reach: processor time of an idle service, of one core; of a capture with a reader, and with the scene, too, as a
multiple of what the same capture costs headless."""

ANSWER_FIGURES = {0.5: 4.0, 0.99: 10.0}
"""To reach: quantiles of the time to the answer to a command [ms]."""

ANSWERS = 300

Figures = dict[str, float]


class Running(NamedTuple):
    """A service in a process of its own."""

    process: subprocess.Popen[str]
    port: int
    first_page: float
    """From the command to the first page [s]."""

    @property
    def api(self) -> str:
        return f"http://127.0.0.1:{self.port}/api/v1"

    def samples(self) -> dict[tuple[str, ...], float]:
        """Its metrics, by name and labels."""
        families = text_string_to_metric_families(httpx.get(f"http://127.0.0.1:{self.port}/metrics", timeout=30).text)
        return {(each.name, *each.labels.values()): each.value for family in families for each in family.samples}


@contextmanager
def service(folder: Path, *options: str) -> Iterator[Running]:
    """One that is ready to fly, of these options of `becalm serve`."""
    command = [sys.executable, "-m", "becalm", "serve", "--port", "0", "--no-open", *options]
    environment = {**os.environ, "BECALM_DATA_DIR": str(folder), "PYTHONUNBUFFERED": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # nobody who installs Becalm reads it from source at each start
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            yield _ready(process, began)
        finally:
            process.terminate()


def _ready(process: subprocess.Popen[str], began: float) -> Running:
    """The service once it can fly."""
    assert process.stdout is not None
    found = re.search(r":(\d+)/", process.stdout.readline())
    assert found, "it says where it is"
    port = int(found[1])
    assert httpx.get(f"http://127.0.0.1:{port}/", timeout=30).status_code == 200
    running = Running(process, port, time.perf_counter() - began)
    while httpx.get(running.api + "/health", timeout=30).json()["status"] != "ok":
        time.sleep(0.05)
    return running


def told(figures: Figures, *, as_json: bool) -> int:
    """Print the figures; for the end of a program."""
    if as_json:
        print(json.dumps(figures, indent=2))
    else:
        for label, value in figures.items():
            print(f"  {value:10.4g}  {label}")
    return 0


def command(running: Running, name: str) -> None:
    """Give the live mission a command."""
    httpx.post(running.api + "/mission/commands", json={"command": name}, timeout=30).raise_for_status()


async def _count(port: int, until: float) -> int:
    """Snapshots that one reader gets, acknowledged as the console does."""
    snapshots = 0
    address = f"ws://127.0.0.1:{port}/api/v1/telemetry?rate={RATE}"
    async with connect(address, max_size=None, proxy=None, compression=None) as socket:
        while time.monotonic() < until:
            text = str(await socket.recv())
            if text.startswith('{"type":"snapshot"'):
                snapshots += 1
                tick = re.search(r'"tick":(\d+)', text)
                assert tick
                await socket.send(json.dumps({"type": "ack", "tick": int(tick[1])}))
    return snapshots


async def _read(port: int, clients: int, duration: float) -> int:
    until = time.monotonic() + duration
    return sum(await asyncio.gather(*(_count(port, until) for _ in range(clients))))


def readers(port: int, clients: int, duration: float) -> int:
    """Snapshots that so many readers get in all, in a process of their own."""
    arguments = [sys.executable, "-m", "benchmarks.service", "--read", str(port), str(clients), str(duration)]
    return int(subprocess.run(arguments, capture_output=True, text=True, check=True).stdout)


def later_than(before: dict[tuple[str, ...], float], after: dict[tuple[str, ...], float], bound: str) -> float:
    """Share of the turns between two looks at the metrics whose oldest tick was later than `bound` [s]."""
    name = "becalm_tick_lateness_seconds_bucket"
    turns, within = (after[name, each] - before[name, each] for each in ("+Inf", bound))
    return 1.0 - within / turns


def headless_cost() -> float:
    """Processor time of a capture that is flown headless, of each simulated second [s]."""
    config, times = named_configuration("published_figures"), []
    prepare(config)
    for _ in range(3):
        before = time.process_time()
        flown = run_capture(config)
        times.append((time.process_time() - before) / flown.simulated_time)
    return min(times)


def cost(running: Running, work: Callable[[], object]) -> float:
    """Processor time of the service while something is done, of one core."""
    before, began = psutil.Process(running.process.pid).cpu_times(), time.monotonic()
    work()
    after, elapsed = psutil.Process(running.process.pid).cpu_times(), time.monotonic() - began
    return (after.user + after.system - before.user - before.system) / elapsed


def _capture_begins(running: Running) -> None:
    command(running, "reset")
    command(running, "capture")


def costs(running: Running) -> Figures:
    """What the live mission costs beside what the same capture costs headless."""
    time.sleep(SETTLING)
    idle, headless = cost(running, lambda: time.sleep(WATCHED)), [headless_cost()]
    captures = {}
    _capture_begins(running)
    captures["a capture, nobody looks"] = cost(running, lambda: time.sleep(FLOWN))
    _capture_begins(running)
    captures["one reader"] = cost(running, lambda: readers(running.port, 1, FLOWN))
    _capture_begins(running)
    with viewer(running.port):
        captures["one reader and the scene"] = cost(running, lambda: readers(running.port, 1, FLOWN))
    command(running, "reset")
    headless.append(headless_cost())
    figures = {"idle, nobody looks: of one core": idle, "idle: of the bound of 5 %": idle / IDLE_FIGURE}
    for label, taken in captures.items():
        figures[f"{label}: of one core"] = taken
        figures[f"{label}: times the same capture headless"] = taken / min(headless)
    figures["headless, in real time: of one core"] = min(headless)
    figures["headless, the slower of two looks, over the quicker"] = max(headless) / min(headless)
    return figures


@contextmanager
def viewer(port: int) -> Iterator[None]:
    """Somebody to whom the scene is sent, in a process of their own."""
    command = [sys.executable, "-m", "benchmarks.service", "--view", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "it is seen\n"
        try:
            yield
        finally:
            process.kill()


async def _view(port: int) -> None:
    """Take whatever the scene sends, as a browser does, for ever."""
    protocol = Subprotocol(f"viser-v{viser.__version__}")
    async with connect(f"ws://127.0.0.1:{port}/scene", subprotocols=[protocol], max_size=None, proxy=None) as socket:
        await socket.recv()
        print("it is seen", flush=True)
        async for _ in socket:
            pass


def answers(running: Running) -> Figures:
    """How soon commands are answered while a capture flies."""
    times = []
    _capture_begins(running)
    before = running.samples()
    with httpx.Client(base_url=running.api, timeout=60) as client:
        for number in range(ANSWERS):
            asked = time.monotonic()
            client.post("/mission/commands", json={"command": "run"}).raise_for_status()
            times.append(1e3 * (time.monotonic() - asked))
            time.sleep(0.003 + 0.001 * (number % 17))
    late = later_than(before, running.samples(), "0.005")
    found = {f"answered, {share:.0%}, ms": float(np.quantile(times, share)) for share in ANSWER_FIGURES}
    bounds = {f"answered, {share:.0%}, of {figure:g} ms": found[f"answered, {share:.0%}, ms"] / figure
              for share, figure in ANSWER_FIGURES.items()}  # fmt: skip
    return {**found, **bounds, "turns later than 5 ms meanwhile": late}


def fan_out(running: Running) -> Figures:
    """Telemetry to more and more readers while a capture flies, and what it costs."""
    figures: Figures = {}
    for clients in CLIENTS:
        command(running, "reset")
        command(running, "capture")
        before = running.samples()
        got = readers(running.port, clients, WATCHED)
        after = running.samples()
        spent = after["process_cpu_seconds_total",] - before["process_cpu_seconds_total",]
        figures[f"{clients} clients: snapshots received, of those asked for"] = got / (clients * RATE * WATCHED)
        figures[f"{clients} clients: processor time of the service, of one core"] = spent / WATCHED
        figures[f"{clients} clients: turns later than 5 ms"] = later_than(before, after, "0.005")
    return figures


def lateness(running: Running, duration: float) -> Figures:
    """How late ticks come with nobody, and with ten readers."""
    figures: Figures = {}
    for clients in (0, 10):
        before = running.samples()
        if clients:
            readers(running.port, clients, duration)
        else:
            time.sleep(duration)
        after = running.samples()
        for bound in ("0.002", "0.005", "0.05"):
            label = f"{clients} readers: turns later than {1e3 * float(bound):g} ms"
            figures[label] = later_than(before, after, bound)
    return figures


def measured() -> dict[str, Figures]:
    """Every table."""
    tables: dict[str, Figures] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with service(folder):
            pass  # compiled code and Python's own are there: the start after it is one as every day's
        with service(folder) as running:
            tables["Start-up"] = {
                "first page, s": running.first_page,
                "first page, of the 3 s to reach": running.first_page / FIRST_PAGE_FIGURE,
            }
            tables["Cost of the live mission"] = costs(running)
            tables["Answers to commands"] = answers(running)
            tables["Lateness of ticks"] = lateness(running, WATCHED)
            tables["Telemetry to many"] = fan_out(running)
    return tables


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--read", nargs=3, help=argparse.SUPPRESS)
    parser.add_argument("--view", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.view:
        asyncio.run(_view(arguments.view))
        return 0
    if arguments.read:
        port, clients, duration = arguments.read
        print(asyncio.run(_read(int(port), int(clients), float(duration))))
        return 0
    tables = measured()
    if arguments.json:
        print(json.dumps(tables, indent=2))
        return 0
    for title, figures in tables.items():
        print(f"\n{title}")
        for label, value in figures.items():
            print(f"  {value:10.3g}  {label}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import httpx
from prometheus_client.parser import text_string_to_metric_families
from websockets.asyncio.client import connect

from server.library.export import MEDIA_TYPES, exported
from server.library.reader import RunReader
from server.library.runs import RunStore, new_record
from server.library.scripted import fly
from sim.capture.mission import prepare
from sim.configurations import named_configuration

FIRST_PAGE_FIGURE = 3.0
"""From the command to the first page [s]."""

RATE = 60.0
"""Snapshots a second that each reader asks for."""

CLIENTS = (1, 10, 30, 100)
WATCHED = 8.0
"""Wall time for each number of clients [s]."""

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


def logs(folder: Path) -> Figures:
    """How fast a capture is written and exported, relative to real time and to flying it without a log."""
    prepare()
    store = RunStore(folder / "runs").make_root()
    record = new_record("scripted", "published", named_configuration("published"))
    store.create(record)
    before = time.perf_counter()
    flown = fly(store, record)
    figures = {"written while flying, times real time": flown.duration / (time.perf_counter() - before)}
    reader = store.read(record.id)
    for log_format in MEDIA_TYPES:
        figures[f"exported as {log_format}, times real time"] = flown.duration / _export_time(reader, log_format)
    figures["log on disk, MB for a simulated second"] = reader.log_path.stat().st_size / 1e6 / flown.duration
    return figures


def _export_time(reader: RunReader, log_format: str) -> float:
    before = time.perf_counter()
    for _ in exported(reader, log_format):  # type: ignore[arg-type]
        pass
    return time.perf_counter() - before


def measured() -> dict[str, Figures]:
    """Every table."""
    tables: dict[str, Figures] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tables["Logs of a capture"] = logs(folder)
        with service(folder):
            pass  # compiled code and Python's own are there: the start after it is one as every day's
        with service(folder) as running:
            tables["Start-up"] = {
                "first page, s": running.first_page,
                "first page, of the 3 s to reach": running.first_page / FIRST_PAGE_FIGURE,
            }
            tables["Lateness of ticks"] = lateness(running, WATCHED)
            tables["Telemetry to many"] = fan_out(running)
    return tables


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--read", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
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

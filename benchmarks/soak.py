"""Whether memory stays flat: `python -m benchmarks.soak --minutes 60`.

A real service flies one capture after another while ten clients read its telemetry, as ten open consoles do. After
each capture its memory is looked at; the trend is that of a straight line through the looks of the second half, by
which caches and buffers have their size, with its 95 % confidence interval. An hour is long enough, half of one just.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import numpy as np
from scipy.stats import linregress, t
from websockets.asyncio.client import connect

from benchmarks.service import Figures, Running, command, service, told

RATE = 10.0
"""Snapshots a second that each client asks for."""

BLOCKS = 12
"""Neighbouring looks are much alike; their means over so many stretches are taken as independent."""


async def _read(port: int) -> None:
    """One client, acknowledging as the console does, until it is killed."""
    async with connect(f"ws://127.0.0.1:{port}/api/v1/telemetry?rate={RATE}", max_size=None, proxy=None) as socket:
        async for text in socket:
            frame = json.loads(text)
            if frame["type"] == "snapshot":
                await socket.send(json.dumps({"type": "ack", "tick": frame["tick"]}))


async def _read_all(port: int, clients: int) -> None:
    await asyncio.gather(*(_read(port) for _ in range(clients)))


@contextmanager
def watched(running: Running, clients: int) -> Iterator[subprocess.Popen[bytes]]:
    """So many clients in a process of their own."""
    arguments = [sys.executable, "-m", "benchmarks.soak", "--read", str(running.port), str(clients)]
    with subprocess.Popen(arguments) as process:
        try:
            yield process
        finally:
            process.kill()


def fly(running: Running) -> None:
    """One capture in real time, to its verdict."""
    command(running, "reset")
    command(running, "capture")
    while httpx.get(running.api + "/mission", timeout=60).json()["outcome"] is None:
        time.sleep(0.5)


def looks(running: Running, duration: float, clients: int) -> np.ndarray:
    """(time [s], memory [MB], open files, clients served) after each capture, shape (captures, 4)."""
    rows: list[tuple[float, ...]] = []
    began = time.monotonic()
    with watched(running, clients) as readers:
        while (elapsed := time.monotonic() - began) < duration or len(rows) < 2 * BLOCKS:
            fly(running)
            found = running.samples()
            memory, files = found["process_resident_memory_bytes",], found["process_open_fds",]
            rows.append((elapsed, 1e-6 * memory, files, found["becalm_telemetry_clients",]))
            print(f"{elapsed:6.0f} s  {rows[-1][1]:6.1f} MB", file=sys.stderr)
            assert readers.poll() is None, "the clients read on"
    return np.array(rows)


def trend(times: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Slope, and half the width of its 95 % confidence interval, each an hour."""
    blocks = np.array_split(np.arange(len(times)), BLOCKS)
    fit = linregress([times[block].mean() for block in blocks], [values[block].mean() for block in blocks])
    return 3600 * fit.slope, 3600 * fit.stderr * t.ppf(0.975, BLOCKS - 2)


def figures_of(rows: np.ndarray) -> Figures:
    """What the looks tell."""
    settled = rows[len(rows) // 2 :]
    slope, half_width = trend(settled[:, 0], settled[:, 1])
    return {
        "minutes": rows[-1, 0] / 60,
        "captures": float(len(rows)),
        "clients served at every look": settled[:, 3].min(),
        "memory after the first capture, MB": rows[0, 1],
        "memory once settled, mean, MB": settled[:, 1].mean(),
        "memory at the end, MB": rows[-1, 1],
        "trend, MB an hour": slope,
        "trend, +- (95 %), MB an hour": half_width,
        "open files at the end, of those once settled": rows[-1, 2] / settled[0, 2],
    }


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0, help="how long captures fly one after another")
    parser.add_argument("--clients", type=int, default=10, help="how many read the telemetry")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--read", nargs=2, type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.read:
        asyncio.run(_read_all(*arguments.read))
        return 0
    with tempfile.TemporaryDirectory() as name, service(Path(name)) as running:
        figures = figures_of(looks(running, 60 * arguments.minutes, arguments.clients))
    return told(figures, as_json=arguments.json)


if __name__ == "__main__":
    sys.exit(main())

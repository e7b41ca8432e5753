"""What is written beside the flight: in order, so far behind and no further."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import cast

import numpy as np

from server.library.background_writer import PARTS_BEHIND, BackgroundWriter
from server.library.record import LoggedEvent
from server.library.writer import RunWriter
from sim.capture.tick import TICK

PATIENCE = 60.0


class SlowDisk:
    """A writer that writes as much as it is let."""

    def __init__(self) -> None:
        self.allowed = threading.Semaphore(0)
        self.written: list[str] = []

    def log(self, event: LoggedEvent) -> None:
        assert self.allowed.acquire(timeout=PATIENCE)
        self.written.append(event.message)

    def append(self, ticks: np.ndarray) -> None:
        assert self.allowed.acquire(timeout=PATIENCE)
        self.written.append(f"part {ticks['time'][-1]:g}")

    def flush(self) -> None:
        pass


def _part(time: float) -> np.ndarray:
    ticks = np.zeros(1, TICK)
    ticks["time"] = time
    return ticks


def _event(message: str) -> LoggedEvent:
    return LoggedEvent(time=0.0, tick=0, kind="mission", severity="info", message=message, at="")


def test_a_flight_waits_for_parts_however_many_events_came_between():
    disk, saved = SlowDisk(), list[float]()
    with ThreadPoolExecutor(1) as flight, BackgroundWriter(cast(RunWriter, disk), saved.append) as background:
        for number in range(PARTS_BEHIND):
            for name in "abcd":
                background.log(_event(f"{number}{name}"))
            background.keep(_part(number))
        assert disk.written == []
        one_more = flight.submit(background.keep, _part(PARTS_BEHIND))
        disk.allowed.release(4)
        assert not one_more.done()
        disk.allowed.release(1)
        one_more.result(PATIENCE)
        assert disk.written[:5] == ["0a", "0b", "0c", "0d", "part 0"]
        assert saved == [0.0]
        disk.allowed.release(100)
    assert disk.written[5:] == ["1a", "1b", "1c", "1d", "part 1", "part 2"]
    assert saved == [0.0, 1.0, 2.0]

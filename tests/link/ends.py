"""Robots and services in processes of their own, and a console's end in the test's own process."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import httpx

from server.link.robot_link import RobotLink
from server.link.zenoh_plant import ZenohPlant
from sim.capture.mission import Mission
from sim.configurations import named_configuration
from sim.control.phases import Command
from sim.errors import LinkLost, MissionRefused

PATIENCE = 60.0
"""Bound on every wait [s]: far beyond any of them, so that only a hang reaches it."""
DEADLINE = 0.6
"""Of both ends [s]: longer than the default, for machines that do much beside these tests."""
CONFIG = named_configuration("testbed")
POLL = 0.01

T = TypeVar("T")


def until(condition: Callable[[], T], what: str) -> T:
    """The first true value of what another process tells; it cannot be waited for but by asking."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(POLL)
    raise AssertionError(f"in vain for {PATIENCE:g} s: {what}")


def free_endpoint(protocol: str = "tcp") -> str:
    """An endpoint that nobody listens on now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"{protocol}/127.0.0.1:{probe.getsockname()[1]}"


class Process:
    """A becalm command in a process of its own."""

    def __init__(self, process: subprocess.Popen[str], log: Path) -> None:
        self.process = process
        self._log = log
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)", line)
        assert found is not None, f"{line!r}; {self.log}"
        self.http = httpx.Client(base_url=f"http://127.0.0.1:{found[1]}", timeout=PATIENCE)

    @property
    def log(self) -> str:
        return self._log.read_text()

    def signal(self, number: signal.Signals) -> None:
        self.process.send_signal(number)


@contextlib.contextmanager
def becalm(folder: Path, *arguments: str) -> Iterator[Process]:
    log = folder / f"{arguments[0]}.log"
    environment = os.environ | {"BECALM_DATA_DIR": str(folder / "data")}
    command = [sys.executable, "-m", "becalm", *arguments]
    with (
        log.open("w") as errors,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, env=environment, text=True) as process,
    ):
        started = None
        try:
            started = Process(process, log)
            yield started
        finally:
            if started is not None:
                started.http.close()
            process.send_signal(signal.SIGCONT)
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


class Robot:
    """The emulated robot, and its REST."""

    def __init__(self, process: Process, endpoint: str) -> None:
        self.process, self.endpoint = process, endpoint

    @property
    def status(self) -> dict[str, Any]:
        return dict(self.process.http.get("/status").raise_for_status().json())

    def suffer(self, **faults: Any) -> None:
        self.process.http.put("/faults", json=faults).raise_for_status()

    def hang(self, duration: float) -> None:
        self.process.http.post("/hang", json={"duration": duration}).raise_for_status()

    def restart(self, pause: float = 0.0, seed: int = 0) -> None:
        boots = self.status["boots"]
        self.process.http.post("/restart", json={"pause": pause, "seed": seed}).raise_for_status()
        until(lambda: self.status["boots"] > boots, "the robot is back")

    def at_rest(self) -> bool:
        return all(abs(rate) < 1e-3 for arm in self.status["joint_rate"] for rate in arm)


class Flight:
    """A mission that flies in a thread until it is asked to end, or the link is lost."""

    def __init__(self, link: RobotLink) -> None:
        plant = until(lambda: _taken(link), "the robot can be flown")
        self.plant = plant
        self.mission = Mission(CONFIG, plant)
        self.lost = threading.Event()
        self.fault: LinkLost | None = None
        self._end = threading.Event()
        self._ticks = 0
        self._told = threading.Condition()
        self._thread = threading.Thread(target=self._fly, daemon=True)
        self._thread.start()

    def capture(self) -> None:
        self.mission.request(Command.CAPTURE)

    def ticks(self, count: int) -> None:
        """Wait until so many more ticks have been flown."""
        with self._told:
            goal = self._ticks + count
            assert self._told.wait_for(lambda: self._ticks >= goal or self.fault, PATIENCE)
            assert self.fault is None, self.fault

    def await_fault(self) -> str:
        assert self.lost.wait(PATIENCE), "the link should be lost"
        return str(self.fault)

    def end(self) -> None:
        self._end.set()
        self._thread.join(PATIENCE)

    def _fly(self) -> None:
        while not self._end.is_set() and self.fault is None:
            self.mission.advance(1)
            with self._told:
                self._ticks += 1
                fault = self.mission.fault
                assert fault is None or isinstance(fault, LinkLost)
                self.fault = fault
                self._told.notify_all()
        if self.fault is not None:
            self.lost.set()


def _taken(link: RobotLink) -> ZenohPlant | None:
    try:
        return ZenohPlant(link, CONFIG)
    except (MissionRefused, LinkLost):
        return None

"""Robots and services in processes of their own, and a console's end in the test's own process."""

from __future__ import annotations

import contextlib
import functools
import math
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
from typing import Any, ClassVar, ParamSpec, TypeVar

import httpx
import numpy as np
import pytest

from server.link.robot_link import RobotLink
from server.link.zenoh_plant import ZenohPlant
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import named_configuration
from sim.control.phases import Command
from sim.errors import LinkLost, MissionRefused

PATIENCE = 120.0
"""Bound on every wait [s]: far beyond any of them, so that only a hang reaches it."""
PATIENT = 5.0
"""Deadline of a console that is to notice nothing [s]: a machine that does much beside it stops for a second."""
SHORT = 0.3
"""Deadline of a console that is to notice a fault [s]."""
ROBOT_DEADLINE = 2.5
"""Of the robot [s]; it has one only."""
STOOD_STILL = 0.05
"""A machine that makes a thread wait for so long [s] does not fly a robot in real time."""
PROBED = 2.0
"""For how long that is looked at beforehand [s]."""
STALLED = r"no [a-z ]+ for \d+ ms|late: what arrives is|refused: measured|jumped by [-+]?\d+ ms|the robot is holding"
"""What either end says of a machine that stood still for longer than the deadline."""
CONFIG = named_configuration("testbed")
POLL = 0.01
REACHED = 0.02
"""How far a target may have drifted and be captured as at the start [m]."""
MOVING = 0.05
"""A joint that is this quick moves [rad/s]."""
RESTS = 0.01
"""A joint that is slower rests [rad/s]: what braking leaves in the joints swings through zero for some periods."""

T = TypeVar("T")
P = ParamSpec("P")


class Stalled(AssertionError):
    """A flight ended by what this machine did, which no test is about."""


class Gaps:
    """The longest time [s] that a thread of this process waited for the machine, beside what it asked for."""

    def __init__(self) -> None:
        self.longest = 0.0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Gaps:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._ended.is_set():
            began = time.monotonic()
            self._ended.wait(0.001)
            self.longest = max(self.longest, time.monotonic() - began - 0.001)


def require_real_time() -> None:
    """Skip the test on a machine that makes threads wait for too long to fly a robot."""
    with Gaps() as gaps:
        time.sleep(PROBED)  # what is looked at is this time itself
    if gaps.longest > STOOD_STILL:
        pytest.skip(f"needs real time: here a thread waited {1e3 * gaps.longest:.0f} ms for a processor")


def keeping_up(test: Callable[P, None]) -> Callable[P, None]:
    """Skip a test whose flight was ended because this machine stood still for longer than a deadline: that is noticed,
    as it should be. It is not restarted, and where the machine did not stand still it has failed."""

    @functools.wraps(test)
    def watched(*args: P.args, **kwargs: P.kwargs) -> None:
        with Gaps() as gaps:
            try:
                test(*args, **kwargs)
            except AssertionError as error:
                stalled = isinstance(error, Stalled) or _stalled(kwargs.get("service"))
                if not stalled or gaps.longest <= STOOD_STILL:
                    raise
                waited = f"a thread waited {1e3 * gaps.longest:.0f} ms for a processor"
                pytest.skip(f"this machine stood still ({waited}), which ended the flight: {str(error)[:200]}")

    return watched


def _stalled(service: Any) -> bool:
    """Whether the flight that was last under way was ended by lateness; the service's is restarted."""
    if service is None:
        return Flight.latest is not None and bool(re.search(STALLED, str(Flight.latest.fault)))
    told = [problem["message"] for problem in service.get("/mission")["problems"]]
    if not any(re.search(STALLED, each) for each in told):
        return False
    service.make_idle()
    return True


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

    @functools.cached_property
    def http(self) -> httpx.Client:
        """Its REST, as soon as it has said where that is; others may start meanwhile."""
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)", line)
        assert found is not None, f"{line!r}; {self.log}"
        return httpx.Client(base_url=f"http://127.0.0.1:{found[1]}", timeout=PATIENCE)

    @property
    def log(self) -> str:
        return self._log.read_text()

    def signal(self, number: signal.Signals) -> None:
        self.process.send_signal(number)

    def close(self) -> None:
        """Ask nothing any more."""
        if "http" in vars(self):
            self.http.close()


@contextlib.contextmanager
def becalm(folder: Path, *arguments: str) -> Iterator[Process]:
    log = folder / f"{arguments[0]}.log"
    environment = os.environ | {"BECALM_DATA_DIR": str(folder / "data")}
    command = [sys.executable, "-m", "becalm", *arguments]
    with (
        log.open("w") as errors,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, env=environment, text=True) as process,
    ):
        started = Process(process, log)
        try:
            yield started
        finally:
            started.close()
            process.send_signal(signal.SIGCONT)
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


class Certificates:
    """An authority of our own, certificates by it, and one by nobody."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._made("req -x509", "ca", "-days 2 -subj /CN=lab")
        self._made("req -x509", "other", "-days 2 -subj /CN=localhost")
        for name in ("robot", "console"):
            self._made("req", name, "-subj /CN=localhost", "csr")
            self._openssl(
                f"x509 -req -in {name}.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 "
                f"-extfile {self._names()} -out {name}.pem"
            )

    def of(self, name: str, authority: str = "ca") -> dict[str, Path]:
        """The settings of an end that has this certificate."""
        return {
            "tls_ca": self._folder / f"{authority}.pem",
            "tls_certificate": self._folder / f"{name}.pem",
            "tls_key": self._folder / f"{name}.key",
        }

    def _made(self, request: str, name: str, rest: str, form: str = "pem") -> None:
        curve = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes"
        self._openssl(f"{request} {curve} -keyout {name}.key -out {name}.{form} {rest}")

    def _names(self) -> str:
        self._folder.joinpath("names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
        return "names"

    def _openssl(self, arguments: str) -> None:
        subprocess.run(["openssl", *arguments.split()], cwd=self._folder, check=True, capture_output=True)


class Robot:
    """The emulated robot, and its REST."""

    def __init__(self, process: Process, endpoint: str, secured: str, credentials: tuple[str, ...]) -> None:
        """A robot at these endpoints; the credentials are options by which another robot may connect to it."""
        self.process, self.endpoint, self.secured, self.credentials = process, endpoint, secured, credentials

    @property
    def status(self) -> dict[str, Any]:
        return dict(self.process.http.get("/status").raise_for_status().json())

    def inject_faults(self, **faults: Any) -> None:
        self.process.http.put("/faults", json=faults).raise_for_status()

    def hang(self, duration: float) -> None:
        self.process.http.post("/hang", json={"duration": duration}).raise_for_status()

    def restart(self, pause: float = 0.0, seed: int = 0) -> None:
        boots = self.status["boots"]
        self.process.http.post("/restart", json={"pause": pause, "seed": seed}).raise_for_status()
        until(lambda: self.status["boots"] > boots, "the robot is back")

    def may_be_captured(self) -> bool:
        """Whether the target is nearly as it was at the start: a capture of it soon moves the arms."""
        target, status = CONFIG.target, self.status
        moved = math.dist(status["target_pose"][:2], (target.initial_x, target.initial_y))
        return moved < REACHED and abs(status["target_twist"][2] - target.initial_spin) < 0.1 * target.initial_spin

    def at_rest(self) -> bool:
        return all(abs(rate) < RESTS for arm in self.status["joint_rate"] for rate in arm)


class Flight:
    """A mission that flies in a thread until it is asked to end, or the link is lost."""

    latest: ClassVar[Flight | None] = None

    def __init__(self, link: RobotLink, config: MissionConfig = CONFIG) -> None:
        Flight.latest = None
        self._link = link
        self._allow(PATIENT)
        self.plant = taken(link, config)
        self.mission = Mission(config, self.plant)
        self.lost = threading.Event()
        self.fault: LinkLost | None = None
        self._end = threading.Event()
        self._ticks = 0
        self._told = threading.Condition()
        self._thread = threading.Thread(target=self._fly, daemon=True)
        self._thread.start()
        Flight.latest = self

    def notice_within(self, deadline: float) -> None:
        """Notice what is late by that much [s] from now on."""
        self._allow(deadline)
        self.ticks(2)  # whoever waits for a joint state now does so with the former deadline

    def capture(self) -> None:
        """Begin a capture, and see the arms move."""
        self.mission.request(Command.CAPTURE)
        self.until(lambda: np.abs(self.plant.state["joint_rate"]).max() > MOVING)

    def until(self, condition: Callable[[], object]) -> None:
        """Wait until that is so after a tick."""
        with self._told:
            assert self._told.wait_for(lambda: self.fault or condition(), PATIENCE)
        if self.fault is not None:
            raise Stalled(self.fault) if re.search(STALLED, str(self.fault)) else AssertionError(self.fault)

    def ticks(self, count: int) -> None:
        """Wait until so many more ticks have been flown."""
        goal = self._ticks + count
        self.until(lambda: self._ticks >= goal)

    def await_fault(self, words: str) -> str:
        """What the console says when it has lost the robot, which must be of that form."""
        assert self.lost.wait(PATIENCE), "the link should be lost"
        message = str(self.fault)
        if not re.search(words, message):
            raise Stalled(message) if re.search(STALLED, message) else AssertionError(message)
        return message

    def end(self) -> None:
        """Fall silent; the robot is not told."""
        self._end.set()
        self._thread.join(PATIENCE)

    def _allow(self, deadline: float) -> None:
        self._link.settings = self._link.settings.model_copy(update={"deadline": deadline})

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


def taken(link: RobotLink, config: MissionConfig = CONFIG) -> ZenohPlant:
    """The robot in a new session, as soon as it can be flown."""

    def asked() -> ZenohPlant | None:
        with contextlib.suppress(MissionRefused, LinkLost):
            return ZenohPlant(link, config)
        return None

    plant = until(asked, "the robot can be flown")
    assert plant is not None
    return plant

"""Captures over the link, seed by seed, and how quick it is: console and robot as two processes on this machine.

    python -m benchmarks.link                        20 seeds with the testbed's defaults
    python -m benchmarks.link --seeds 3 --idle 600   and ten minutes of watching for lost states
    python -m benchmarks.link --realtime             on a machine that does much beside it
    python -m benchmarks.link --deadline 0.3         on one that stands still for 100 ms at a time (Linux)
    python -m benchmarks.link --configuration testbed_becalm --seeds 50      our own method; in lots: --first 10 ...
    python -m benchmarks.link --set published.impedance.damping=1.5 --set published.impedance.stiffness=10

The robot is restarted with each seed, so the target spins as at the start; an operator's reset takes it again.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np

START_TIME = 180.0
CAPTURE_TIME = 60.0


@contextlib.contextmanager
def process(*arguments: str, data: Path) -> Iterator[str]:
    """A becalm command that has said that it is ready; gives the line in which it did."""
    command = [sys.executable, "-m", "becalm", *arguments]
    environment = os.environ | {"BECALM_DATA_DIR": str(data)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment, text=True) as it:
        assert it.stdout is not None
        try:
            line = it.stdout.readline()
            assert "is ready" in line, (arguments, line)
            yield line
        finally:
            it.terminate()


def until(condition: Any, timeout: float, what: str) -> Any:
    """The first true value of the condition."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise TimeoutError(what)


def port_of(line: str) -> int:
    """The port of the address in a line."""
    found = re.search(r"http://127\.0\.0\.1:(\d+)", line)
    assert found is not None, line
    return int(found[1])


def free_port() -> int:
    """A port that nobody listens on now."""
    import socket  # noqa: PLC0415

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Stalls:
    """The longest time [s] that a processor kept a thread waiting, real time if that may be, beyond what it asked for.

    One that stands still for a deadline lets an end of the link do so, too: both then hold, as they should.
    """

    def __init__(self, *, realtime: bool) -> None:
        self._realtime = realtime
        self._longest = 0.0
        for processor in sorted(os.sched_getaffinity(0)):
            threading.Thread(target=self._watch, args=(processor,), daemon=True).start()

    def take(self) -> float:
        """The longest since the last call."""
        longest, self._longest = self._longest, 0.0
        return longest

    def _watch(self, processor: int) -> None:
        os.sched_setaffinity(0, {processor})
        if self._realtime:
            os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(3))
        while True:
            began = time.monotonic()
            time.sleep(0.002)
            self._longest = max(self._longest, time.monotonic() - began - 0.002)


class Pair:
    """Console and robot."""

    def __init__(self, console: httpx.Client, robot: httpx.Client, stalls: Stalls) -> None:
        self.console, self.robot, self._stalls = console, robot, stalls

    def command(self, **body: Any) -> dict[str, Any]:
        """Ask the mission; try again while it is refused, for the robot may not be back yet."""

        def asked() -> Any:
            answer = self.asked(body)
            return answer.json() if answer.status_code == 200 else None

        return dict(until(asked, 10.0, f"{body} is granted"))

    def asked(self, body: dict[str, Any]) -> httpx.Response:
        """The answer to a command, armed before, as what moves a robot has to be."""
        arming = self.console.post("/api/v1/mission/arming", json=body)
        token = arming.json().get("token") if arming.status_code == 200 else None
        return self.console.post("/api/v1/mission/commands", json={**body, "arming": token})

    def link(self) -> dict[str, Any]:
        """The link's state."""
        return dict(self.console.get("/api/v1/link").json())

    def capture(self, seed: int) -> dict[str, Any]:
        """One capture with the robot restarted."""
        self.robot.post("/restart", json={"pause": 0.2, "seed": seed}).raise_for_status()
        until(lambda: self.mission()["phase"] == "faulted", 5.0, "the console notices the restart")
        self.begin()
        self._stalls.take()
        ended = until(self._ended, CAPTURE_TIME, "the capture ends")
        link, stalled = self.link(), self._stalls.take()
        outcome = ended["outcome"] or {}
        return {
            "seed": seed,
            "phase": ended["phase"],
            "outcome": outcome.get("outcome"),
            "caged": bool(outcome.get("caged")),
            "peak": outcome.get("peak_tip_force"),
            "true_peak": self.robot.get("/status").json()["peak_force"],
            "peak_to_closure": outcome.get("peak_tip_force_to_closure"),
            "duration": outcome.get("duration"),
            "final_spin": outcome.get("final_target_spin"),
            "processor_stood_still": round(stalled, 4),
            "activity": None if outcome.get("caged") else ended["description"],
            "round_trip_p99": (link["round_trip"] or {}).get("p99"),
            "command_age_p50": (link["command_age"] or {}).get("p50"),
            "command_age_p99": (link["command_age"] or {}).get("p99"),
            "problem": [each["message"] for each in ended["problems"]] if ended["phase"] == "faulted" else [],
        }

    def begin(self) -> None:
        """Take the robot and capture; what was lost before the capture began is taken again, as an operator would."""

        def begun() -> bool:
            self.command(command="reset")
            answer = self.asked({"command": "capture"})
            if answer.status_code != 200:
                print([each["message"] for each in self.mission()["problems"]], file=sys.stderr, flush=True)
            return answer.status_code == 200

        until(begun, 60.0, "the capture begins")

    def mission(self) -> dict[str, Any]:
        """The latest snapshot."""
        return dict(self.console.get("/api/v1/mission").json())

    def _ended(self) -> dict[str, Any] | None:
        mission = self.mission()
        return mission if mission["outcome"] or mission["phase"] == "faulted" else None


@contextlib.contextmanager
def pair(chosen: argparse.Namespace) -> Iterator[Pair]:
    """Console and robot as the arguments say, connected and ready."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    shared = ["--configuration", chosen.configuration, *(["--realtime"] if chosen.realtime else [])]
    robot_options = [word for setting in chosen.imperfection for word in ("--imperfection", setting)]
    console_options = [word for setting in chosen.settings for word in ("--set", setting)]
    if chosen.deadline is not None:
        robot_options += ["--deadline", str(chosen.deadline)]
        console_options += ["--link-deadline", str(chosen.deadline)]
    serve = ("serve", "--no-open", "--port", "0", "--plant", "zenoh", "--connect", endpoint)
    with (
        tempfile.TemporaryDirectory() as data,
        process("robot", "--listen", endpoint, *shared, *robot_options, data=Path(data)) as robot,
        process(*serve, *shared, *console_options, data=Path(data)) as console,
    ):
        both = Pair(
            httpx.Client(base_url=f"http://127.0.0.1:{port_of(console)}", timeout=10),
            httpx.Client(base_url=f"http://127.0.0.1:{port_of(robot)}", timeout=10),
            Stalls(realtime=chosen.realtime),
        )
        until(lambda: both.console.get("/api/v1/mission").status_code == 200, START_TIME, "the mission begins")
        yield both


def watch(both: Pair, duration: float) -> dict[str, Any]:
    """An idle mission for a while [s]: what is lost, and how quick it is; a robot that is lost is taken again."""
    before = {each["key"]: each for each in both.link()["streams"]}
    trips, ages, again = [], [], 0
    end = time.monotonic() + duration
    while time.monotonic() < end:
        time.sleep(5.0)
        link = both.link()
        if link["problem"] or not link["held"]:
            print(link["problem"], [each["message"] for each in both.mission()["problems"]], file=sys.stderr)
            both.command(command="reset")
            again += 1
            continue
        trips.append(link["round_trip"]["p99"])
        ages.append(link["command_age"]["p99"])
    streams = {each["key"]: each for each in link["streams"]}
    joints = "becalm/joint_states"
    return {
        "duration": duration,
        "states": streams[joints]["received"] - before[joints]["received"],
        "lost": streams[joints]["lost"] - before[joints]["lost"],
        "round_trip_p50": link["round_trip"]["p50"],
        "round_trip_p99": float(np.median(trips)),
        "command_age_p50": link["command_age"]["p50"],
        "command_age_p99": float(np.median(ages)),
        "taken_again": again,
        "clock_offset": link["clock_offset"],
        "phase": both.mission()["phase"],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--configuration", default="testbed", help="that console and robot have")
    parser.add_argument("--idle", type=float, default=0.0, help="watch an idle mission for so many seconds first")
    parser.add_argument("--realtime", action="store_true", help="both processes; takes the right to it")
    parser.add_argument("--deadline", type=float, help="of both ends, in place of their own [s]")
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="PATH=VALUE")
    parser.add_argument("--imperfection", action="append", default=[], metavar="NAME=VALUE")
    chosen = parser.parse_args()
    with pair(chosen) as both:
        if chosen.idle:
            print(json.dumps(watch(both, chosen.idle)), flush=True)
        flown = []
        for seed in range(chosen.first, chosen.first + chosen.seeds):
            flown.append(both.capture(seed))
            print(json.dumps(flown[-1]), flush=True)
    caged = [each for each in flown if each["caged"]]
    print(f"{len(caged)} of {len(flown)} caged")
    for name in ("peak", "true_peak", "peak_to_closure", "duration", "final_spin"):
        values = [abs(each[name]) for each in caged]
        if values:
            print(f"{name}: median {np.median(values):.3g}, from {min(values):.3g} to {max(values):.3g}")


if __name__ == "__main__":
    main()

"""Everything at once, for a bounded time: STOP is obeyed each time, nothing is lost, memory stays, the service ends.

Twenty seconds, or as many as BECALM_SOAK_SECONDS says (`make soak`). Loopback only; every load ends by itself.
"""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from pathlib import Path

import pytest

from benchmarks.loads import PATIENCE, client, library, under
from benchmarks.service import service
from benchmarks.stop import command, stop
from server.access.roles import Role
from server.access.tokens import TokenStore
from sim.capture.mission import prepare
from sim.config import MissionConfig

SECONDS = float(os.environ.get("BECALM_SOAK_SECONDS", "20"))

STOP_BOUND = 0.5
"""Within which STOP is obeyed on a machine whose cores are all busy [s]: these loads keep both of two busy."""

MEMORY_BOUND = 200e6
"""What the service may take more than at its start [bytes]; what these loads sent would fill gigabytes."""

END_BOUND = 5.0
"""Within which the service ends, whatever is unread or half requested [s]."""


class Wakefulness:
    """How late this process itself is woken by a machine that is full: no service on it can be prompter."""

    PERIOD = 0.01

    def __init__(self):
        self.worst = 0.0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self):
        before = time.monotonic()
        while not self._ended.wait(self.PERIOD):
            now = time.monotonic()
            self.worst, before = max(self.worst, now - before - self.PERIOD), now

    def since_last(self):
        worst, self.worst = self.worst, 0.0
        return worst

    def end(self):
        self._ended.set()
        self._thread.join()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A data folder in which tokens are needed; who has BECALM_TOKEN in the environment has one."""
    prepare(MissionConfig())
    secret = TokenStore(tmp_path / "access").create("ana", Role.ADMIN)
    monkeypatch.setenv("BECALM_TOKEN", secret)
    monkeypatch.setenv("BECALM_REQUIRE_TOKENS", "true")
    return tmp_path


def resident(pid: int) -> int:
    """Memory of a process [bytes]."""
    fields = Path(f"/proc/{pid}/statm").read_text().split()
    return int(fields[1]) * os.sysconf("SC_PAGE_SIZE")


def records(folder: Path):
    return [json.loads(path.read_text()) for path in sorted((folder / "runs").glob("*/run.json"))]


def test_stop_is_obeyed_each_time_while_everybody_does_everything(folder):
    run_id = library(folder, seconds=20.0)
    wakeful = Wakefulness()
    with service(folder) as running, client(running.port) as http:
        before = resident(running.process.pid)
        tries, late = 0, []
        with under("everything", running.port, run_id, SECONDS + PATIENCE):
            until = time.monotonic() + SECONDS
            while time.monotonic() < until:
                command(http, "reset")
                command(http, "capture")
                time.sleep(0.1)
                wakeful.since_last()
                found = stop(http, folder)
                tries += 1
                if found.obeyed_after > STOP_BOUND + wakeful.since_last():
                    late.append(found)
                if tries == 1:
                    (folder / "access" / "tokens.json").write_text("{damaged")
            assert resident(running.process.pid) - before < MEMORY_BOUND
            asked = time.monotonic()
            running.process.terminate()  # with everything unread and half requested
            running.process.wait(PATIENCE)
            took = time.monotonic() - asked
    wakeful.end()
    assert (tries > 1, late) == (True, [])
    assert running.process.returncode in (0, -signal.SIGTERM)
    assert took < END_BOUND + wakeful.worst
    flown = [record for record in records(folder) if record["kind"] == "live"]
    assert len(flown) >= tries
    assert {record["integrity"] for record in flown} == {"complete"}
    audited = [json.loads(line) for line in (folder / "access" / "audit.log").read_text().splitlines()]
    assert sum(line.get("path") == "/api/v1/mission/stop" for line in audited) == tries

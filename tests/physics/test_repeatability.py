"""The same configuration and seed give the same run, bit for bit, in any process and however it is cut in pieces."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.run import run_capture
from sim.config import Engine
from sim.configurations import named_configuration, revised
from sim.control.phases import Command


def digest(ticks) -> str:
    """Of every field of every tick (the padding between fields is nobody's)."""
    whole = hashlib.sha256()
    for name in ticks.dtype.names:
        whole.update(np.ascontiguousarray(ticks[name]).tobytes())
    return whole.hexdigest()


def flown_in_chunks(ticks: int):
    """Direct caging to its verdict, that many ticks a call."""
    mission = Mission(named_configuration("published"))
    mission.request(Command.DIRECT_CAGE)
    rows = []
    while mission.outcome is None:
        rows.append(mission.advance(ticks))
    return mission, np.concatenate(rows)


def published_digest(engine: str) -> str:
    ticks: list = []
    config = revised(named_configuration("published"), {"simulation": {"engine": engine}})
    run_capture(config, on_ticks=ticks.append)
    return digest(np.concatenate(ticks))


@pytest.fixture(params=[engine.value for engine in Engine])
def engine(request) -> str:
    return request.param


def test_again_in_this_process(fly, engine):
    assert published_digest(engine) == digest(fly("published", changes={"simulation.engine": engine}).ticks)


def test_in_a_fresh_process(fly, engine):
    script = f"from test_repeatability import published_digest; print(published_digest({engine!r}))"
    fresh = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=_environment(), timeout=300
    )
    assert fresh.stdout.strip() == digest(fly("published", changes={"simulation.engine": engine}).ticks)


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONHASHSEED": "7"}


def test_whatever_the_number_of_ticks_a_call(fly):
    whole = fly("published", direct=True)
    for chunk in (1, 7, 1000):
        mission, ticks = flown_in_chunks(chunk)
        assert digest(ticks) == digest(whole.ticks), f"{chunk} ticks a call"
        assert mission.outcome == whole.outcome


def test_events_do_not_depend_on_the_number_of_ticks_a_call():
    told = []
    for chunk in (1, 7, 1000):
        mission, _ = flown_in_chunks(chunk)
        told.append([(event.tick, event.kind, event.message) for event in mission.take_events()])
    assert told[0] == told[1] == told[2]


def test_two_missions_at_once_do_not_disturb_each_other(fly):
    missions = [Mission(named_configuration("published")) for _ in range(2)]
    for mission in missions:
        mission.request(Command.DIRECT_CAGE)
    rows: list[list] = [[], []]
    for _ in range(30):
        for place, mission in enumerate(missions):
            rows[place].append(mission.advance(100))
    first, second = (np.concatenate(part) for part in rows)
    assert digest(first) == digest(second) == digest(fly("published", direct=True).ticks[:3000])

"""How much is compiled: nothing in an empty cache, all when a mission can fly, whichever process compiled it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sim.capture.compile_progress import compiled_share
from sim.capture.mission import prepare
from sim.capture.monitor import watch
from sim.capture.tick_loop import fly
from sim.compiled import CompiledFunction, reached_from
from sim.config import Engine, MissionConfig
from sim.configurations import revised
from sim.plant.engine import ENGINES

LOOK = """
import pytest

from sim.capture.compile_progress import compiled_share
from sim.config import Engine, MissionConfig
print(compiled_share(MissionConfig()))
"""


def _share_in_another_process(**environment: str) -> float:
    command = [sys.executable, "-c", LOOK]
    found = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=True)
    return float(found.stdout)


def test_it_goes_from_nothing_to_all(tmp_path: Path) -> None:
    prepare(MissionConfig())
    assert compiled_share(MissionConfig()) == 1.0
    assert _share_in_another_process() == 1.0
    assert _share_in_another_process(NUMBA_CACHE_DIR=str(tmp_path)) == 0.0


def test_an_engine_counts_what_is_its_own() -> None:
    reduced = revised(MissionConfig(), {"simulation": {"engine": "reduced"}})
    prepare(reduced)
    assert compiled_share(reduced) == 1.0


def test_what_is_called_is_reached() -> None:
    assert isinstance(watch, CompiledFunction)
    assert watch in reached_from([fly])
    assert fly not in reached_from([watch])


def test_a_plant_that_python_steps_needs_no_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    def is_compiled(function: CompiledFunction) -> bool:
        return function is not fly and function.module != ENGINES[Engine.PYMUNK].__module__

    monkeypatch.setattr(CompiledFunction, "is_compiled", property(is_compiled))
    assert compiled_share(MissionConfig(), simulated=False) == 1.0
    assert compiled_share(MissionConfig()) < 1.0

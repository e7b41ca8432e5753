"""Whole captures, each flown once a session and shared by the tests that read it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from sim.capture.events import Event, Ticks
from sim.capture.mission import prepare
from sim.capture.run import run_capture
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.snapshot import Outcome


class Flown(NamedTuple):
    """A headless capture: every tick, and how it ended."""

    ticks: Ticks
    outcome: Outcome
    events: list[Event]

    @property
    def hand_force(self) -> np.ndarray:
        """Resultant of each hand's tips [N], shape (ticks, 2)."""
        return np.hypot(self.ticks["hand_wrench"][..., 0], self.ticks["hand_wrench"][..., 1])

    def largest_force(self, start: float, end: float) -> float:
        """Largest hand resultant between two times [N]."""
        between = (self.ticks["time"] >= start) & (self.ticks["time"] < end)
        return float(self.hand_force[between].max())


Fly = Callable[..., Flown]


@cache
def _flown(name: str, direct: bool, changes: tuple[tuple[str, Any], ...]) -> Flown:
    config = revised(named_configuration(name), nested(dict(changes)))
    ticks: list[Ticks] = []
    result = run_capture(config, direct=direct, on_ticks=ticks.append)
    return Flown(np.concatenate(ticks), result.outcome, result.events)


@pytest.fixture(scope="session", autouse=True)
def _prepared() -> None:
    prepare(MissionConfig())


@pytest.fixture(scope="session")
def fly(_prepared) -> Fly:
    """`fly(name, direct=False, changes={path: value})`: that capture, flown at the first call only."""

    def fly(name: str, *, direct: bool = False, changes: Mapping[str, Any] | None = None) -> Flown:
        return _flown(name, direct, tuple((changes or {}).items()))

    return fly

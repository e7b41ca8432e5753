"""What is watched of the live mission, and the limits of each signal: defaults here, and what a lab chose instead."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import Literal, NamedTuple, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from server.edge.values import Number
from server.errors import StoredUnreadable
from server.files import read_document, replace_file
from server.library.plotted import Values
from server.library.record import TickArray
from sim.errors import ConfigError
from sim.snapshot import FrozenMessage

LevelName = Literal["watch", "warning", "critical"]
Side = Literal["above", "below"]


class Level(IntEnum):
    """How far a signal is beyond its limits."""

    NORMAL = 0
    WATCH = 1
    WARNING = 2
    CRITICAL = 3


class Limits(BaseModel):
    """The bounds of a signal, each beyond the one before it; SI."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    watch: Number | None = Field(None, description="Worth a look; null for none")
    warning: Number | None = Field(None, description="To be acknowledged; null for none")
    critical: Number | None = Field(None, description="To be acknowledged at once; null for none")
    hysteresis: Number = Field(0.0, ge=0, description="So far back within a bound it is left, so that nothing flickers")

    def bound(self, level: Level) -> float | None:
        """The bound of that level; None if it has none."""
        return {Level.WATCH: self.watch, Level.WARNING: self.warning, Level.CRITICAL: self.critical}.get(level)

    def level(self, value: float, side: Side, before: Level) -> Level:
        """How far a value is beyond them, after it was as far as `before`."""
        sign = 1.0 if side == "above" else -1.0
        for level in (Level.CRITICAL, Level.WARNING, Level.WATCH):
            bound = self.bound(level)
            if bound is None:
                continue
            left_at = sign * bound - (self.hysteresis if before >= level else 0.0)
            if sign * value > left_at:
                return level
        return Level.NORMAL

    def require_order(self, side: Side) -> Self:
        """These limits.

        Raises:
            ConfigError: a level lies within the one before it.

        """
        set_bounds = [(level, bound) for level in list(Level)[1:] if (bound := self.bound(level)) is not None]
        sign = 1.0 if side == "above" else -1.0
        for (inner, one), (outer, other) in itertools.pairwise(set_bounds):
            if sign * other <= sign * one:
                name, before = outer.name.lower(), inner.name.lower()
                raise ConfigError(f"{name} = {other:g}: must be {side} {before}, which is {one:g}")
        return self


class Signal(NamedTuple):
    """Something that is watched."""

    name: str
    title: str
    unit: str
    side: Side
    """Where its limits are gone beyond."""
    default: Limits
    description: str
    of: Callable[[TickArray], Values] | None
    """Its values over an array of `TICK`, shape (ticks,); None if it is no column of a tick."""


def _larger(values: Values) -> Values:
    largest: Values = np.abs(values).reshape(len(values), -1).max(axis=1)
    return largest


def _tip_force(ticks: TickArray) -> Values:
    force: Values = np.hypot(ticks["hand_wrench"][:, :, 0], ticks["hand_wrench"][:, :, 1]).max(axis=1)
    return force


def _drift(ticks: TickArray) -> Values:
    drift: Values = np.hypot(ticks["target_twist"][:, 0], ticks["target_twist"][:, 1])
    return drift


def _least_manipulability(ticks: TickArray) -> Values:
    least: Values = ticks["manipulability"].min(axis=1)
    return least


SIGNALS: dict[str, Signal] = {
    signal.name: signal
    for signal in (
        Signal(
            "tip_force",
            "Tip force",
            "N",
            "above",
            Limits(watch=1.2, warning=2.5, critical=5.0, hysteresis=0.1),
            "The larger of both hands' resultants; direct caging reaches 1.13 N",
            _tip_force,
        ),
        Signal(
            "target_spin",
            "Spin of the target",
            "rad/s",
            "above",
            Limits(watch=3.2, warning=4.5, critical=6.0, hysteresis=0.1),
            "Its angular velocity, whatever its sense",
            lambda ticks: np.abs(ticks["target_twist"][:, 2]),
        ),
        Signal(
            "target_drift",
            "Drift of the target",
            "m/s",
            "above",
            Limits(watch=0.1, warning=0.2, critical=0.4, hysteresis=0.01),
            "Speed of its centre",
            _drift,
        ),
        Signal(
            "base_rate",
            "Rate of the base",
            "rad/s",
            "above",
            Limits(watch=0.5, warning=1.0, critical=2.0, hysteresis=0.05),
            "Its angular velocity, whatever its sense",
            lambda ticks: np.abs(ticks["base_twist"][:, 2]),
        ),
        Signal(
            "base_attitude",
            "Attitude of the base",
            "rad",
            "above",
            Limits(watch=0.35, warning=0.8, critical=1.6, hysteresis=0.02),
            "Its angle from where the mission began",
            lambda ticks: np.abs(ticks["base_pose"][:, 2]),
        ),
        Signal(
            "manipulability",
            "Manipulability",
            "m2",
            "below",
            Limits(watch=0.015, warning=0.01, critical=0.003, hysteresis=0.001),
            "The lesser of both arms: near zero an arm is at a singularity",
            _least_manipulability,
        ),
        Signal(
            "joint_rate",
            "Joint rate",
            "rad/s",
            "above",
            Limits(watch=3.0, warning=6.0, critical=9.0, hysteresis=0.1),
            "The largest measured one of all joints, whatever its sense",
            lambda ticks: _larger(ticks["joint_rate"]),
        ),
        Signal(
            "lateness",
            "Lateness of ticks",
            "s",
            "above",
            Limits(watch=0.25, warning=1.0, hysteresis=0.05),
            "Worst of the last second; a simulation that falls behind loses nothing but time",
            None,
        ),
        Signal(
            "robot_age",
            "Age of the robot's data",
            "s",
            "above",
            Limits(watch=0.1, warning=0.25, hysteresis=0.02),
            "Of the stream that came longest ago among those that are needed",
            None,
        ),
    )
}
"""What is watched, by name."""


class ChosenLimits(FrozenMessage):
    """Limits that somebody chose in place of the defaults."""

    limits: Limits
    who: str
    at: str = Field(description="When, ISO 8601 in UTC")


class _LimitsFile(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: int = 1
    chosen: dict[str, ChosenLimits] = {}

    @model_validator(mode="after")
    def _known(self) -> Self:
        """What is not watched any more is left out, not refused."""
        self.chosen = {name: each for name, each in self.chosen.items() if name in SIGNALS}
        return self


class LimitStore:
    """The limits of one data folder, in one file that is replaced as a whole; from any thread."""

    def __init__(self, folder: Path) -> None:
        """Read nothing yet."""
        self._path = folder / "limits.json"
        self._lock = threading.Lock()
        self._chosen: dict[str, ChosenLimits] | None = None
        self.trouble: str | None = None
        """Why what was chosen cannot be read: the defaults hold then."""

    @property
    def chosen(self) -> dict[str, ChosenLimits]:
        """By the signal's name; replaced, never changed."""
        with self._lock:
            return self._read()

    def limits(self, name: str) -> Limits:
        """Of that signal."""
        chosen = self.chosen.get(name)
        return SIGNALS[name].default if chosen is None else chosen.limits

    def choose(self, name: str, limits: Limits, *, who: str, at: str) -> ChosenLimits:
        """Keep these limits of a signal.

        Raises:
            ConfigError: they are out of order, or there is no such signal.

        """
        chosen = ChosenLimits(limits=limits.require_order(signal_of(name).side), who=who, at=at)
        self._replace({**self.chosen, name: chosen})
        return chosen

    def forget(self, name: str) -> None:
        """Back to the defaults of a signal.

        Raises:
            ConfigError: there is no such signal.

        """
        signal_of(name)
        self._replace({kept: each for kept, each in self.chosen.items() if kept != name})

    def _read(self) -> dict[str, ChosenLimits]:
        if self._chosen is None:
            try:
                self._chosen = read_document(self._path, _LimitsFile).chosen
            except FileNotFoundError:
                self._chosen = {}
            except StoredUnreadable as error:
                self._chosen, self.trouble = {}, str(error)
        return self._chosen

    def _replace(self, chosen: dict[str, ChosenLimits]) -> None:
        with self._lock:
            content = _LimitsFile(chosen=chosen).model_dump_json(indent=1)
            replace_file(self._path, content.encode())
            self._chosen, self.trouble = chosen, None


def signal_of(name: str) -> Signal:
    """The signal of that name.

    Raises:
        ConfigError: there is none.

    """
    signal = SIGNALS.get(name)
    if signal is None:
        raise ConfigError(f"signal = {name[:60]!r}: nothing of that name is watched; known: {', '.join(SIGNALS)}")
    return signal

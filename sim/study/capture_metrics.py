"""What a study measures of a capture while it flies, beyond its outcome: the first touch, the peak, the base."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from sim.capture.events import Ticks
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.method import method_of
from sim.snapshot import Outcome


class ContactStage(StrEnum):
    """Where in a capture a contact falls."""

    TOUCH = "touch"
    """While the target is being detumbled, up to the plan that closes the hands."""
    CLOSING = "closing"
    """While the hands close, up to the first closed instant."""
    AFTER_CLOSURE = "after_closure"
    """After the first closed instant, which the paper's classification leaves out."""


class _Signals(NamedTuple):
    """One value each tick."""

    time: FloatArray
    target_twist: FloatArray
    base_angle: FloatArray
    hand_force: FloatArray
    """The larger of both hands' resultants [N]."""
    closing: FloatArray
    """Whether the hands are closing or wait at the end of their closing plan."""


class CaptureMetrics:
    """What is measured of one capture, from its ticks in their order."""

    def __init__(self, config: MissionConfig) -> None:
        self._signals: list[_Signals] = []
        self._closing = method_of(config).closing

    def update(self, ticks: Ticks) -> None:
        """Take in consecutive ticks."""
        force = np.hypot(ticks["hand_wrench"][:, :, 0], ticks["hand_wrench"][:, :, 1]).max(axis=1)
        closing = (ticks["phase"] == Phase.CAGING) & np.isin(ticks["activity"], self._closing)
        self._signals.append(
            _Signals(
                time=ticks["time"].copy(),
                target_twist=ticks["target_twist"].copy(),
                base_angle=ticks["base_pose"][:, 2].copy(),
                hand_force=force,
                closing=closing | (ticks["phase"] == Phase.HOLDING),
            )
        )

    def measures(self, outcome: Outcome) -> dict[str, float | str | None]:
        """The measures of the capture that ended with this outcome."""
        signals = _Signals(*map(np.concatenate, zip(*self._signals, strict=True)))
        turned = float(signals.base_angle[np.argmax(np.abs(signals.base_angle))])
        return {**_peak(signals, outcome), **_first_touch(signals, outcome), "base_turn": turned}


def _peak(signals: _Signals, outcome: Outcome) -> dict[str, float | str | None]:
    """When the largest force of all came, and in which stage; nothing if no tip touched."""
    place = int(np.argmax(signals.hand_force))
    if signals.hand_force[place] == 0.0:
        return {"peak_at": None, "peak_stage": None}
    peak_at = float(signals.time[place])
    stage = ContactStage.CLOSING if signals.closing[place] else ContactStage.TOUCH
    if outcome.closed_at is not None and peak_at > outcome.closed_at:
        stage = ContactStage.AFTER_CLOSURE
    return {"peak_at": peak_at, "peak_stage": stage.value}


def _first_touch(signals: _Signals, outcome: Outcome) -> dict[str, float | str | None]:
    """The first touch, and how the target spins and drifts when it ends."""
    first = outcome.contacts[0] if outcome.contacts else None
    if first is None or first.end is None:
        names = ("first_touch_end", "first_touch_peak", "spin_after_first_touch", "drift_after_first_touch")
        return dict.fromkeys(names)
    vx, vy, spin = signals.target_twist[min(int(np.searchsorted(signals.time, first.end)), len(signals.time) - 1)]
    return {
        "first_touch_end": first.end,
        "first_touch_peak": first.peak,
        "spin_after_first_touch": float(spin),
        "drift_after_first_touch": math.hypot(vx, vy),
    }

"""What a study measures of a capture beyond its outcome: the first touch, the peak, the base."""

from __future__ import annotations

import math
from enum import StrEnum

from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.method import method_of
from sim.record import Record
from sim.snapshot import Outcome


class ContactStage(StrEnum):
    """Where in a capture a contact falls."""

    TOUCH = "touch"
    """While the target is being detumbled, up to the plan that closes the hands."""
    CLOSING = "closing"
    """While the hands close, up to the first closed instant."""
    AFTER_CLOSURE = "after_closure"
    """After the first closed instant, which the paper's classification leaves out."""


def capture_metrics(monitor: Record, outcome: Outcome, config: MissionConfig) -> dict[str, float | str | None]:
    """The measures of a capture that ended with this outcome.

    Args:
        monitor: what was noted of it, one element of `MONITOR`.
        outcome: how it ended.
        config: with which it was flown.

    """
    turned = float(monitor["base_turn"])
    return {**_peak(monitor, outcome, config), **_first_touch(monitor, outcome), "base_turn": turned}


def _peak(monitor: Record, outcome: Outcome, config: MissionConfig) -> dict[str, float | str | None]:
    """When the largest force of all came, and in which stage; nothing if no tip touched."""
    peak_at, phase = float(monitor["peak_at"]), Phase(int(monitor["peak_phase"]))
    if math.isnan(peak_at):
        return {"peak_at": None, "peak_stage": None}
    closing = phase is Phase.CAGING and int(monitor["peak_activity"]) in method_of(config).closing
    stage = ContactStage.CLOSING if closing or phase is Phase.HOLDING else ContactStage.TOUCH
    if outcome.closed_at is not None and peak_at > outcome.closed_at:
        stage = ContactStage.AFTER_CLOSURE
    return {"peak_at": peak_at, "peak_stage": stage.value}


def _first_touch(monitor: Record, outcome: Outcome) -> dict[str, float | str | None]:
    """The first touch, and how the target spins and drifts when it ends."""
    first = outcome.contacts[0] if outcome.contacts else None
    if first is None or first.end is None:
        names = ("first_touch_end", "first_touch_peak", "spin_after_first_touch", "drift_after_first_touch")
        return dict.fromkeys(names)
    vx, vy, spin = monitor["touches"][0]["target_twist"]
    return {
        "first_touch_end": first.end,
        "first_touch_peak": first.peak,
        "spin_after_first_touch": float(spin),
        "drift_after_first_touch": math.hypot(vx, vy),
    }

"""The paper's experiment on the air-bearing testbed (Sec. V), flown again: what is flown, and what is measured of it.

Who flies it is a robot behind a link, or one that is emulated; nothing here knows which.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.capture.events import Ticks
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.control.phases import Phase
from sim.method.method import method_of
from sim.snapshot import Outcome

SINGULAR = 0.006
"""Manipulability under which an arm counts as at a singularity [m2]: the floor of our own method's plans."""

PAPER: Mapping[str, Mapping[str, Any]] = {
    "direct": {"peak_force": 4.4},
    "published": {"peak_force": 0.48, "final_spin": 0.16, "caged": False},
}
"""What Sec. V-C states: forces at the wrists [N], the spin that was left [rad/s]."""

_EXPERIMENT = {"mass": 0.1, "damping": 1.5, "stiffness": 10.0}
"""Impedance of Sec. V-A; its gains are those of the configuration `testbed`."""


class Trial(NamedTuple):
    """One way of capturing that is flown with every seed."""

    name: str
    title: str
    config: MissionConfig
    direct: bool
    """Without detumbling."""


def trials() -> tuple[Trial, ...]:
    """The paper's two, and ours."""
    experiment = revised(named_configuration("testbed"), {"published": {"impedance": _EXPERIMENT}})
    return (
        Trial("direct", "Direct caging", experiment, direct=True),
        Trial("published", "Detumbling and caging", experiment, direct=False),
        Trial("becalm", "Our own method", named_configuration("testbed_becalm"), direct=False),
    )


class Truth(NamedTuple):
    """What an emulated robot knows of a flight beside what its sensors gave."""

    peak_force: float
    """Largest force of a hand, in the control periods [N]."""
    spin: float
    """Of the target at the end [rad/s]."""
    cage_margin: float
    """Of the hands where they truly are [m]; not positive if the target is free."""


class FlownTrial(NamedTuple):
    """One capture on the testbed with every tick of it."""

    trial: str
    seed: int
    config: MissionConfig
    ticks: Ticks
    outcome: Outcome | None
    """None if the arms held without a verdict."""
    ended: str
    """Why a flight without a verdict ended; empty of one that has it."""
    truth: Truth


class LowPoint(NamedTuple):
    """Where an arm was nearest to a singularity."""

    manipulability: float
    """[m2]"""
    arm: str
    time: float
    """[s]"""
    activity: str


def low_point(flight: FlownTrial) -> LowPoint:
    """Where an arm of that flight was nearest to a singularity."""
    values = flight.ticks["manipulability"]
    place, arm = np.unravel_index(int(np.argmin(values)), values.shape)
    row = flight.ticks[place]
    activity = method_of(flight.config).activities(int(row["activity"]))
    words = activity.name.lower() if activity else Phase(int(row["phase"])).label
    return LowPoint(float(values[place, arm]), ("left", "right")[arm], float(row["time"]), words)


def is_caged(flight: FlownTrial) -> bool:
    """Whether the verdict says so, and the true poses, too."""
    return flight.outcome is not None and flight.outcome.caged and flight.truth.cage_margin > 0.0


def measures(flight: FlownTrial) -> dict[str, Any]:
    """One row of the table of all flights."""
    outcome, low = flight.outcome, low_point(flight)
    turned = float(np.abs(flight.ticks["base_pose"][:, 2]).max())
    return {
        "trial": flight.trial,
        "seed": flight.seed,
        "outcome": "no verdict" if outcome is None else outcome.outcome.value,
        "caged": is_caged(flight),
        "peak_force": flight.truth.peak_force,
        "felt_force_to_closure": None if outcome is None else outcome.peak_tip_force_to_closure,
        "locked_at": None if outcome is None else outcome.locked_at,
        "final_spin": flight.truth.spin,
        "base_rotation_deg": math.degrees(turned),
        "least_manipulability": low.manipulability,
        "nearest_arm": low.arm,
        "nearest_at": low.time,
        "nearest_while": low.activity,
        "singular": low.manipulability < SINGULAR,
        "ended": flight.ended,
    }


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Of all flights of one trial, rows as `measures` gives them."""
    whiles = [row["nearest_while"] for row in rows if row["singular"]]
    return {
        "flights": len(rows),
        "caged": sum(row["caged"] for row in rows),
        "peak_force": _spread(rows, "peak_force"),
        "felt_force_to_closure": _spread(rows, "felt_force_to_closure"),
        "locked_at": _spread([row for row in rows if row["caged"]], "locked_at"),
        "final_spin": _spread(rows, "final_spin"),
        "base_rotation_deg": _spread(rows, "base_rotation_deg"),
        "least_manipulability": _spread(rows, "least_manipulability"),
        "singular": sum(row["singular"] for row in rows),
        "singular_while": max(sorted(set(whiles)), key=whiles.count) if whiles else None,
    }


def _spread(rows: Sequence[Mapping[str, Any]], name: str) -> dict[str, float] | None:
    """Least, median and largest size; None if nothing was measured."""
    values = [abs(row[name]) for row in rows if row[name] is not None]
    if not values:
        return None
    return {"least": min(values), "median": float(np.median(values)), "largest": max(values)}


def shown(flights: Sequence[FlownTrial]) -> FlownTrial:
    """Of the flights of one trial the one in the middle by its least manipulability; of two that of the lesser one."""
    ordered = sorted(flights, key=lambda flight: (low_point(flight).manipulability, flight.seed))
    return ordered[(len(ordered) - 1) // 2]


def nearest(flights: Sequence[FlownTrial]) -> FlownTrial:
    """Of the flights of one trial the one that came nearest to a singularity."""
    return min(flights, key=lambda flight: (low_point(flight).manipulability, flight.seed))

"""What is measured of a flight of the experiment, on ticks that were made up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.capture.tick import TICK
from sim.control.phases import Phase
from sim.method.published.memory import Activity
from sim.reproduction.testbed import (
    SINGULAR,
    FlownTrial,
    Trial,
    Truth,
    low_point,
    measures,
    nearest,
    shown,
    summary,
    trials,
)


def _trial(name: str) -> Trial:
    return next(each for each in trials() if each.name == name)


def _flown(seed: int, least: float, margin: float = 0.01, spin: float = -0.2) -> FlownTrial:
    """A flight of ten ticks whose right arm comes down to that manipulability at the seventh, while it closes."""
    ticks = np.zeros(10, TICK)
    ticks["time"] = 0.1 * np.arange(10)
    ticks["phase"], ticks["activity"] = int(Phase.CAGING), int(Activity.CLOSING)
    ticks["manipulability"] = 0.04
    ticks["manipulability"][7, 1] = least
    ticks["base_pose"][3, 2] = -0.5
    return FlownTrial(
        "published", seed, _trial("published").config, ticks, None, "held", Truth(2.0 + seed, spin, margin)
    )


def test_the_trials_are_the_papers_and_ours() -> None:
    direct, published, ours = trials()
    impedance = published.config.published.impedance
    assert (impedance.mass, impedance.damping, impedance.stiffness) == (0.1, 1.5, 10.0)
    assert (published.config.control.tracking.proportional, published.config.control.tracking.integral) == (2.5, 0.10)
    assert direct.config == published.config
    assert (direct.direct, published.direct, ours.direct) == (True, False, False)
    assert ours.config.robot == published.config.robot
    assert ours.config.target == published.config.target


def test_the_low_point_says_which_arm_when_and_doing_what() -> None:
    low = low_point(_flown(0, 0.001))
    assert (low.manipulability, low.arm, low.activity) == (0.001, "right", "closing")
    assert low.time == pytest.approx(0.7)


def test_a_flight_without_verdict_is_a_row_too() -> None:
    row = measures(_flown(0, 0.001))
    assert row["outcome"] == "no verdict"
    assert not row["caged"]
    assert row["singular"]
    assert row["base_rotation_deg"] == pytest.approx(math.degrees(0.5))
    assert row["locked_at"] is None
    assert row["ended"] == "held"


def test_a_summary_gives_least_median_and_largest_sizes() -> None:
    flights = [_flown(seed, least) for seed, least in enumerate((0.03, 0.5 * SINGULAR, 0.02))]
    found = summary([measures(flight) for flight in flights])
    assert found["peak_force"] == {"least": 2.0, "median": 3.0, "largest": 4.0}
    assert found["final_spin"] == {"least": 0.2, "median": 0.2, "largest": 0.2}
    assert (found["flights"], found["caged"], found["singular"]) == (3, 0, 1)
    assert found["locked_at"] is None
    assert found["singular_while"] == "closing"
    assert summary([measures(flights[0])])["singular_while"] is None
    assert shown(flights).seed == 2
    assert nearest(flights).seed == 1

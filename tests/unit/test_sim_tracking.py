"""Feed-forward and PID on the pose error."""

from __future__ import annotations

import numpy as np
import pytest

from sim.config import TrackingConfig
from sim.control.tracking import tracking_velocity
from sim.record import record_of

PERIOD = 1e-3
DESIRED, TWIST = np.array([0.1, 0.2, 0.3]), np.array([0.01, -0.02, 0.05])
POSE, MEASURED = np.array([0.09, 0.22, 0.25]), (0.02, 0.0, 0.0)


def velocity(gathered=None, **gains):
    result, integral = np.zeros(3), np.zeros(3) if gathered is None else gathered
    tracking_velocity(record_of(TrackingConfig(**gains)), PERIOD, DESIRED, TWIST, POSE, MEASURED, integral, result)
    return result


def test_without_gains_it_is_the_feed_forward():
    assert velocity().tolist() == TWIST.tolist()


def test_proportional_adds_to_it_by_the_error():
    assert velocity(proportional=2.5) == pytest.approx(TWIST + 2.5 * (DESIRED - POSE))


def test_derivative_adds_by_the_error_of_the_twist():
    assert velocity(derivative=0.5) == pytest.approx(TWIST + 0.5 * (TWIST - MEASURED))


def test_integral_gathers_error_over_time():
    gathered = np.zeros(3)
    for _ in range(100):
        result = velocity(gathered, integral=0.1)
    assert gathered == pytest.approx(100 * PERIOD * (DESIRED - POSE))
    assert result == pytest.approx(TWIST + 0.1 * gathered)

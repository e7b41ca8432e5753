"""The emulated sensors: as noisy as they say, the same for the same seed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from server.link.imperfections import TARE_SAMPLES, Imperfections, Sensors
from sim.plant.plant import PLANT_STATE

PERFECT = Imperfections(**dict.fromkeys(Imperfections.model_fields, 0.0))
SAMPLES = 4000
FIVE_SIGMA = 5.0 / math.sqrt(2 * SAMPLES)
"""Relative bound of a standard deviation's estimate."""


def _state():
    state = np.zeros(1, PLANT_STATE)[0]
    state["joint_angle"][:] = 0.3
    state["hand_wrench"][:] = [[1.0, 2.0, 0.1], [0.0, 0.0, 0.0]]
    return state


def _wrenches(sensors, count, angle=0.0):
    told = []
    for _ in range(count):
        sensors.sense(_state(), np.full(2, angle))
        told.append([each.value for each in sensors.wrenches(0)])
    return np.array(told)


def test_a_perfect_sensor_tells_the_truth_in_the_hands_axes():
    told = _wrenches(Sensors(PERFECT, 0), 1, math.pi / 2)[0]
    np.testing.assert_allclose(told[0], [2.0, -1.0, 0.1], atol=1e-15)


def test_noise_is_as_large_as_it_says():
    told = _wrenches(Sensors(PERFECT.model_copy(update={"force_noise": 0.05}), 3), SAMPLES)
    assert told[:, 1, 0].std() == pytest.approx(0.05, rel=FIVE_SIGMA)
    assert told[:, 1, 2].std() == 0.0


def test_taring_takes_the_bias_away():
    sensors = Sensors(Imperfections(force_bias=1.0), 5)
    before = _wrenches(sensors, TARE_SAMPLES)[:, 1].mean(axis=0)
    assert np.abs(before[:2]).max() > 0.1
    # The present load counts as zero, too: a sensor cannot know.
    sensors.tare()
    after = _wrenches(sensors, 400)[:, :, :2].mean(axis=0)
    np.testing.assert_allclose(after, 0.0, atol=5 * 0.02 / math.sqrt(TARE_SAMPLES))


def test_the_same_seed_tells_the_same():
    first, second, other = (_wrenches(Sensors(Imperfections(), seed), 5) for seed in (7, 7, 8))
    np.testing.assert_array_equal(first, second)
    assert (first != other).all()


def test_encoders_have_steps_and_rates_are_their_differences():
    sensors = Sensors(PERFECT.model_copy(update={"encoder_resolution": 0.01}), 0)
    state = _state()
    sensors.sense(state, np.zeros(2))
    assert not sensors.joints(0).rate.any()
    state["joint_angle"][0, 0] += 0.013
    sensors.sense(state, np.zeros(2))
    sample = sensors.joints(5_000_000)
    assert sample.angle[0, 0] == pytest.approx(0.31)
    assert sample.rate[0, 0] == pytest.approx(2.0)


def test_motion_capture_misses_and_errs_as_often_as_it_says():
    sensors = Sensors(PERFECT.model_copy(update={"dropouts": 0.2, "outliers": 0.1, "outlier_distance": 0.5}), 1)
    seen = []
    for _ in range(SAMPLES):
        sensors.sense(_state(), np.zeros(2))
        seen.append(sensors.pose(0, "target"))
    missed = sum(each is None for each in seen) / SAMPLES
    far = sum(each is not None and math.hypot(*each.value[:2]) > 0.4 for each in seen) / (SAMPLES * 0.8)
    assert missed == pytest.approx(0.2, abs=5 * math.sqrt(0.2 * 0.8 / SAMPLES))
    assert far == pytest.approx(0.1, abs=5 * math.sqrt(0.1 * 0.9 / (0.8 * SAMPLES)))

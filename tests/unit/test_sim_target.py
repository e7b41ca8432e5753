"""The square: a point in its frame, and its distance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.config import TargetConfig
from sim.model.planar import rotated
from sim.model.target import distance_from_square, in_target, target_model

HALF = 0.075
coordinates = st.floats(-0.5, 0.5)
compiling = settings(deadline=None)  # the first example may compile


@compiling
@given(coordinates, coordinates, st.floats(-10.0, 10.0))
def test_in_target_undoes_the_targets_pose(x, y, angle):
    pose = np.array([0.2, -0.4, angle])
    dx, dy = rotated(angle, x, y)
    assert in_target(pose, pose[0] + dx, pose[1] + dy) == pytest.approx((x, y), abs=1e-12)


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((0.0, 0.0), -HALF),
        ((HALF, 0.0), 0.0),
        ((0.1, 0.02), 0.025),
        ((-0.02, -0.1), 0.025),
        ((HALF + 0.03, HALF + 0.04), 0.05),
        ((0.07, 0.0), -0.005),
    ],
    ids=["centre", "on a face", "beside a face", "below a face", "beyond a corner", "just inside"],
)
def test_distance(point, distance):
    assert distance_from_square(HALF, *point) == pytest.approx(distance)


@compiling
@given(coordinates, coordinates, st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3))
def test_distance_is_the_same_on_every_side_and_never_outruns_the_point(x, y, dx, dy):
    here = distance_from_square(HALF, x, y)
    assert distance_from_square(HALF, -y, x) == pytest.approx(here, abs=1e-15)
    assert abs(distance_from_square(HALF, x + dx, y + dy) - here) <= math.hypot(dx, dy) + 1e-15


def test_half_diagonal():
    assert target_model(TargetConfig()).half_diagonal == pytest.approx(0.075 * math.sqrt(2.0))

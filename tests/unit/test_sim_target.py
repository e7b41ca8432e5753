"""The target: its configured shape, and a point in its frame."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.config import TargetConfig, TargetShape
from sim.model.planar import rotated
from sim.model.shape import signed_distance
from sim.model.target import SIZES, in_target, target_model, target_shape

AXES = (((1.0, 0.0), (-1.0, 0.0)), ((0.0, 1.0), (0.0, -1.0)))
coordinates = st.floats(-0.5, 0.5)
compiling = settings(deadline=None)  # the first example may compile


@compiling
@given(coordinates, coordinates, st.floats(-10.0, 10.0))
def test_in_target_undoes_the_targets_pose(x, y, angle):
    pose = np.array([0.2, -0.4, angle])
    dx, dy = rotated(angle, x, y)
    assert in_target(pose, pose[0] + dx, pose[1] + dy) == pytest.approx((x, y), abs=1e-12)


@pytest.mark.parametrize(
    ("target", "extents"),
    [
        ({"side": 0.12}, (0.12, 0.12)),
        ({"shape": TargetShape.RECTANGLE, "width": 0.3, "depth": 0.1}, (0.3, 0.1)),
        ({"shape": TargetShape.CIRCLE, "radius": 0.08}, (0.16, 0.16)),
        ({"shape": TargetShape.REGULAR_POLYGON, "sides": 6, "side": 0.1}, (0.1 * math.sqrt(3.0), 0.2)),
        ({"shape": TargetShape.REGULAR_POLYGON, "sides": 8, "side": 0.1}, (0.1 * (1.0 + math.sqrt(2.0)),) * 2),
    ],
)
def test_a_configured_shape_has_its_extents(target, extents):
    shape = target_model(TargetConfig(**target)).shape
    reach = np.array([[-signed_distance(shape, 9.0 * x, 9.0 * y) + 9.0 for x, y in axes] for axes in AXES])
    assert reach.sum(axis=1) == pytest.approx(extents)


@pytest.mark.parametrize("shape", TargetShape)
def test_the_sizes_of_a_shape_are_what_it_follows_from(shape):
    config = TargetConfig(shape=shape)
    original = target_shape(config).corner_circle
    for name in ("side", "width", "depth", "sides", "radius"):
        changed = config.model_copy(update={name: getattr(config, name) + 1})
        assert (target_shape(changed).corner_circle != original) == (name in SIZES[shape])


@pytest.mark.parametrize("shape", TargetShape)
def test_the_configuration_knows_how_far_its_shape_reaches(shape):
    config = TargetConfig(shape=shape)
    assert config.reach == pytest.approx(target_shape(config).corner_circle)

"""The target's configured shape."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import TargetConfig, TargetShape
from sim.model.target import SIZES, target_model, target_shape


@pytest.mark.parametrize(
    ("target", "extents"),
    [
        ({"side": 0.12}, (0.12, 0.12)),
        ({"shape": TargetShape.RECTANGLE, "width": 0.3, "depth": 0.1}, (0.3, 0.1)),
        ({"shape": TargetShape.CIRCLE, "radius": 0.08}, (0.16, 0.16)),
        ({"shape": TargetShape.REGULAR_POLYGON, "sides": 6, "side": 0.1}, (0.1 * math.sqrt(3.0), 0.2)),
        ({"shape": TargetShape.REGULAR_POLYGON, "sides": 8, "side": 0.1}, (0.1 * (1.0 + math.sqrt(2.0)),) * 2),
        ({"shape": TargetShape.POLYGON, "vertices": ((5.0, 1.0), (5.2, 1.0), (5.0, 1.1))}, (0.2, 0.1)),
    ],
)
def test_a_configured_shape_has_its_extents(target, extents):
    shape = target_model(TargetConfig(**target)).shape
    corners = shape.vertices[: shape.corners]
    assert np.ptp(corners, axis=0) + 2.0 * shape.rounding == pytest.approx(extents)


@pytest.mark.parametrize("shape", TargetShape)
def test_the_sizes_of_a_shape_are_what_it_follows_from(shape):
    config = TargetConfig(shape=shape)
    original = target_shape(config).corner_circle
    larger = {name: getattr(config, name) + 1 for name in ("side", "width", "depth", "sides", "radius")}
    larger["vertices"] = tuple((2.0 * x, 2.0 * y) for x, y in config.vertices)
    for name, value in larger.items():
        changed = config.model_copy(update={name: value})
        assert (target_shape(changed).corner_circle != original) == (name in SIZES[shape])


def test_the_vertices_of_a_polygon_are_about_its_centroid_wherever_their_origin_was():
    corners = ((0.0, 0.0), (0.18, 0.0), (0.0, 0.12))
    for x, y in ((0.0, 0.0), (-3.0, 7.0)):
        moved = tuple((x + each, y + other) for each, other in corners)
        shape = target_shape(TargetConfig(shape=TargetShape.POLYGON, vertices=moved))
        assert shape.vertices[:3] == pytest.approx(np.array([[-0.06, -0.04], [0.12, -0.04], [-0.06, 0.08]]))

"""The markers of a log: the target is a solid of its shape."""

from __future__ import annotations

import numpy as np
import pytest

from server.log.ros import store
from server.log.scene import MARKERS, prism, scene
from sim.config import MissionConfig
from sim.model.shape import area, signed_distance
from sim.model.target import target_shape

SHAPES = (
    {"shape": "square"},
    {"shape": "rectangle"},
    {"shape": "regular_polygon", "sides": 5},
    {"shape": "polygon", "vertices": [[0.0, 0.0], [0.14, 0.0], [0.11, 0.10], [0.0, 0.13]]},
    {"shape": "circle"},
)
every_target = pytest.mark.parametrize("target", SHAPES, ids=lambda target: target["shape"])


@every_target
def test_the_targets_marker_has_its_outline(target):
    config = MissionConfig.model_validate({"target": target})
    markers = store().deserialize_cdr(scene(config), MARKERS).markers
    (marker,) = [each for each in markers if each.header.frame_id == "target"]
    shape = target_shape(config.target)
    assert marker.type == 11
    assert len(marker.points) % 3 == 0
    assert [signed_distance(shape, point.x, point.y) for point in marker.points] == pytest.approx(
        [0.0] * len(marker.points), abs=1e-12
    )


@every_target
def test_its_triangles_are_closed_and_face_outwards(target):
    shape = target_shape(MissionConfig.model_validate({"target": target}).target)
    a, b, c = prism(shape).reshape(-1, 3, 3).transpose(1, 0, 2)
    assert np.cross(b - a, c - a).sum(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert float((np.cross(a, b) * c).sum()) / 6.0 == pytest.approx(area(shape) * 0.06, rel=3e-3)

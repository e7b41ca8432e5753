"""Solids are closed, face outwards, and keep to their measures; the file that carries them is glTF."""

import json
import math
import struct

import numpy as np
import pytest

from server.scene import solids
from server.scene.glb import glb, linear
from server.scene.machine import base_parts, hand_parts, target_parts
from server.scene.palette import GRAPHITE, SHELL
from sim.config import MissionConfig

CONFIG = MissionConfig()
FACETS = 0.03
"""What flat facets take from a round volume, at nine points a quarter."""


def volume(solid):
    """By the divergence theorem; negative if the faces look inwards."""
    a, b, c = (solid.vertices[solid.faces[:, corner]] for corner in range(3))
    return float(np.sum(np.cross(a, b) * c) / 6)


@pytest.mark.parametrize(
    ("solid", "expected"),
    [
        (solids.box(0.3, 0.2, 0.0, 0.1, 0.001), 0.3 * 0.2 * 0.1),
        (solids.drum(0.1, -0.1, 0.2), math.pi * 0.1**2 * 0.3),
        (solids.ball(0.05), 4 / 3 * math.pi * 0.05**3),
        (solids.rod((0.1, 0.1), (0.1, 0.3), 0.01), math.pi * 0.01**2 * (0.2 + 4 / 3 * 0.01)),
        (solids.prism(solids.stadium(0.2, 0.02, 0.01), 0.0, 1.0), 0.2 * 0.03 + (0.02**2 + 0.01**2) * math.pi / 2),
    ],
)
def test_a_solid_has_its_volume_and_faces_outwards(solid, expected):
    assert volume(solid) == pytest.approx(expected, rel=FACETS)


@pytest.mark.parametrize(
    "solid",
    [
        solids.box(0.3, 0.2, 0.0, 0.1, 0.01, bevel=0.005),
        solids.prism(solids.stadium(0.2, 0.02, 0.01), -0.01, 0.01, 0.004),
        solids.drum(0.1, 0.0, 0.1, 0.01).turned(solids.TO_X),
        solids.ball(0.05).turned(solids.TO_Y),
    ],
)
def test_normals_are_unit_and_agree_with_the_faces(solid):
    assert np.linalg.norm(solid.normals, axis=1) == pytest.approx(np.ones(len(solid.normals)))
    a, b, c = (solid.vertices[solid.faces[:, corner]] for corner in range(3))
    facing = np.cross(b - a, c - a)
    real = np.linalg.norm(facing, axis=1) > 1e-12
    smooth = solid.normals[solid.faces].mean(axis=1)
    assert np.all(np.sum(facing * smooth, axis=1)[real] > 0)


def extent(parts):
    vertices = np.concatenate([solid.vertices for solid, _ in parts])
    return vertices.min(axis=0), vertices.max(axis=0)


def test_the_target_is_as_wide_as_the_square_that_is_touched():
    low, high = extent(target_parts(CONFIG.target.side))
    assert high[:2] == pytest.approx([0.075, 0.075], abs=0.0011)
    assert low[:2] == pytest.approx([-0.075, -0.075], abs=0.0011)


def test_the_tips_are_where_the_configuration_has_them():
    _, high = extent(hand_parts(CONFIG.robot.arm.hand))
    assert high[0] == pytest.approx(0.039749 + 0.015, abs=1e-9)
    assert high[1] == pytest.approx(0.041556 + 0.015, abs=1e-9)


def test_nothing_reaches_through_the_table():
    height = 0.0725
    low, _ = extent(base_parts(CONFIG.robot, height))
    assert low[2] + height >= 0.0


def test_the_file_is_gltf_whose_accessors_fit_its_buffer():
    content = glb([(solids.ball(0.1), SHELL), (solids.ball(0.2), GRAPHITE), (solids.ball(0.3), SHELL)])
    magic, version, length = struct.unpack_from("<III", content)
    assert (magic, version, length) == (0x46546C67, 2, len(content))
    text_length, _ = struct.unpack_from("<II", content, 12)
    document = json.loads(content[20 : 20 + text_length])
    assert len(document["materials"]) == len(document["meshes"][0]["primitives"]) == 2
    binary = content[20 + text_length + 8 :]
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= len(binary)
    position = document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    assert document["accessors"][position]["max"] == pytest.approx([0.3, 0.3, 0.3], abs=2e-3)


def test_colours_become_linear_light():
    assert linear((0, 255, 10)) == pytest.approx([0.0, 1.0, 10 / 255 / 12.92])

"""Solids are closed, face outwards, and keep to their measures; the file that carries them is glTF."""

import io
import json
import math
import struct

import numpy as np
import pytest
import trimesh

from server.scene import solids
from server.scene.glb import glb, linear
from server.scene.machine import base_parts, hand_parts
from server.scene.palette import GRAPHITE, SHELL, TARGET
from server.scene.target import ghost_parts, half_height, target_parts
from sim.config import MissionConfig
from sim.model.shape import area, circle, polygon, rectangle, regular_polygon, signed_distance

CONFIG = MissionConfig()
FACETS = 0.03
"""What flat facets take from a round volume, at nine points a quarter."""


SHAPES = {
    "square": rectangle(0.15, 0.15),
    "rectangle": rectangle(0.2, 0.1),
    "triangle": regular_polygon(3, 0.2),
    "hexagon": regular_polygon(6, 0.08),
    "circle": circle(0.075),
    "rounded": polygon(np.array([[0.06, -0.05], [0.08, 0.04], [-0.02, 0.07], [-0.09, -0.03]]), 0.01),
}
every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)


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


@every_shape
def test_the_target_reaches_as_far_as_the_outline_that_is_touched_and_no_farther(shape):
    vertices = np.concatenate([solid.vertices for solid, _ in target_parts(shape)])
    distances = [signed_distance(shape, float(x), float(y)) for x, y, _ in vertices]
    assert max(distances) == pytest.approx(0.0, abs=0.0011)
    for side in range(shape.sides):
        reached = (vertices[:, :2] @ shape.normals[side]).max()
        assert reached == pytest.approx(shape.offsets[side] + shape.rounding, abs=0.0011)


@every_shape
def test_the_ghost_is_a_prism_of_the_target(shape):
    (body, _), _ = ghost_parts(shape, TARGET)
    assert volume(body) == pytest.approx(area(shape) * 2.0 * half_height(shape), rel=0.05)


def test_the_tips_are_where_the_configuration_has_them():
    _, high = extent(hand_parts(CONFIG.robot.arm.hand))
    assert high[0] == pytest.approx(0.039749 + 0.015, abs=1e-9)
    assert high[1] == pytest.approx(0.041556 + 0.015, abs=1e-9)


def test_nothing_reaches_through_the_table():
    height = 0.0725
    low, _ = extent(base_parts(CONFIG.robot, height))
    assert low[2] + height >= 0.0


def test_the_file_is_gltf_with_a_mesh_and_its_exact_material_for_all_parts_of_one():
    content = glb([(solids.ball(0.1), SHELL), (solids.ball(0.2), GRAPHITE), (solids.ball(0.3), SHELL)])
    magic, version, length = struct.unpack_from("<III", content)
    assert (magic, version, length) == (0x46546C67, 2, len(content))
    text_length, _ = struct.unpack_from("<II", content, 12)
    document = json.loads(content[20 : 20 + text_length])
    assert len(document["materials"]) == len(document["meshes"]) == 2
    for radius, material, mesh in zip((0.3, 0.2), (SHELL, GRAPHITE), document["meshes"], strict=True):
        (primitive,) = mesh["primitives"]
        surface = document["materials"][primitive["material"]]["pbrMetallicRoughness"]
        assert surface["baseColorFactor"] == [*linear(material.colour), material.opacity]
        position, normal = (document["accessors"][primitive["attributes"][each]] for each in ("POSITION", "NORMAL"))
        assert position["max"] == pytest.approx([radius] * 3, abs=2e-3)
        assert normal["count"] == position["count"]


def test_the_file_is_read_again_with_the_normals_that_it_was_given():
    solid = solids.ball(0.1)
    scene = trimesh.load_scene(io.BytesIO(glb([(solid, SHELL)])), file_type="glb")
    (mesh,) = scene.geometry.values()
    assert np.asarray(mesh.vertices) == pytest.approx(solid.vertices, abs=1e-7)
    assert np.asarray(mesh.vertex_normals) == pytest.approx(solid.normals, abs=1e-6)
    assert np.array_equal(mesh.faces, solid.faces)


def test_colours_become_linear_light():
    assert linear((0, 255, 10)) == pytest.approx([0.0, 1.0, 10 / 255 / 12.92])

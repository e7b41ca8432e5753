"""Shapes: distance and normal, corner circle, symmetry, area and inertia; by values and by independent references."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sim.errors import ConfigError
from sim.model.shape import (
    Shape,
    about_its_centroid,
    area,
    circle,
    even_plate,
    facing_side,
    inner_radius,
    outline,
    plate_inertia,
    polygon,
    rectangle,
    regular_polygon,
    signed_distance,
    surface,
)

SIDE, WIDTH, DEPTH, RADIUS = 0.15, 0.20, 0.10, 0.075
IRREGULAR = about_its_centroid(np.array([[0.0, 0.0], [0.12, -0.02], [0.17, 0.05], [0.09, 0.14], [-0.02, 0.10]]))
SHAPES = {
    "square": rectangle(SIDE, SIDE),
    "rectangle": rectangle(WIDTH, DEPTH),
    "triangle": regular_polygon(3, SIDE),
    "hexagon": regular_polygon(6, 0.08),
    "circle": circle(RADIUS),
    "irregular": polygon(IRREGULAR),
    "rounded": polygon(IRREGULAR, 0.02),
    "base": rectangle(0.32, 0.16, 0.076),
}
every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
coordinates = st.floats(-0.4, 0.4)
compiling = settings(deadline=None)  # the first example may compile


def reference_distance(shape: Shape, x: float, y: float) -> float:
    """Signed distance by brute force: nearest of all sides' points, inside by the winding of the corners."""
    corners = [complex(*corner) for corner in shape.vertices[: shape.corners]]
    point = complex(x, y)
    nearest = math.inf
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        along = end - start
        part = 0.0 if along == 0 else ((point - start) * along.conjugate()).real / abs(along) ** 2
        nearest = min(nearest, abs(point - start - min(max(part, 0.0), 1.0) * along))
    turns = [(end - point) / (start - point) for start, end in zip(corners, [*corners[1:], corners[0]], strict=True)]
    inside = abs(sum(math.atan2(turn.imag, turn.real) for turn in turns)) > math.pi
    return (-nearest if inside else nearest) - shape.rounding


@pytest.mark.parametrize(
    ("name", "point", "distance", "normal"),
    [
        ("square", (0.1, 0.02), 0.025, (1, 0)),
        ("square", (-0.02, -0.1), 0.025, (0, -1)),
        ("square", (0.105, 0.115), 0.05, (0.6, 0.8)),
        ("square", (0.07, 0.0), -0.005, (1, 0)),
        ("rectangle", (0.0, 0.06), 0.01, (0, 1)),
        ("rectangle", (-0.13, -0.09), 0.05, (-0.6, -0.8)),
        ("rectangle", (0.0, 0.0), -0.05, None),
        ("hexagon", (0.08, 0.01), 0.08 * (1 - math.sqrt(3) / 2), (1, 0)),
        ("hexagon", (0.0, 0.1), 0.02, (0, 1)),
        ("circle", (0.03, 0.04), -0.025, (0.6, 0.8)),
        ("circle", (0.0, -0.1), 0.025, (0, -1)),
        ("base", (0.0, 0.014), 0.010, (0, 1)),
        ("base", (0.18, -0.1), 0.02, (1, 0)),
    ],
)
def test_distance_and_normal(name, point, distance, normal):
    found, *direction = surface(SHAPES[name], *point)
    assert found == pytest.approx(distance)
    assert normal is None or direction == pytest.approx(normal)


@every_shape
@compiling
@given(coordinates, coordinates)
def test_distance_is_that_of_brute_force(shape, x, y):
    assume(np.hypot(*(shape.vertices[: shape.corners] - (x, y)).T).min() > 1e-9)
    assert signed_distance(shape, x, y) == pytest.approx(reference_distance(shape, x, y), abs=1e-12)


@every_shape
@compiling
@given(coordinates, coordinates)
def test_normal_is_the_slope_of_the_distance(shape, x, y):
    assume(np.hypot(*(shape.vertices[: shape.corners] - (x, y)).T).min() > 1e-9)  # a corner has no one normal
    distance, nx, ny = surface(shape, x, y)
    step = 1e-7
    assert math.hypot(nx, ny) == pytest.approx(1.0)
    slope_x = (signed_distance(shape, x + step, y) - signed_distance(shape, x - step, y)) / (2 * step)
    slope_y = (signed_distance(shape, x, y + step) - signed_distance(shape, x, y - step)) / (2 * step)
    assume(distance > 1e-3 - shape.rounding or math.hypot(slope_x, slope_y) > 0.999)  # not where two sides are as near
    assert (slope_x, slope_y) == pytest.approx((nx, ny), abs=1e-3)


@every_shape
@compiling
@given(coordinates, coordinates, st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3))
def test_distance_never_outruns_the_point(shape, x, y, dx, dy):
    change = signed_distance(shape, x + dx, y + dy) - signed_distance(shape, x, y)
    assert abs(change) <= math.hypot(dx, dy) + 1e-15


@every_shape
@compiling
@given(coordinates, coordinates)
def test_is_the_same_after_a_turn_of_its_symmetry(shape, x, y):
    turn = shape.symmetry_angle or 0.7
    c, s = math.cos(turn), math.sin(turn)
    here, there = signed_distance(shape, x, y), signed_distance(shape, c * x - s * y, s * x + c * y)
    assert there == pytest.approx(here, abs=1e-12)


@every_shape
@compiling
@given(st.floats(-math.pi, math.pi))
def test_lies_within_its_corner_circle_and_reaches_it(shape, angle):
    x, y = math.cos(angle), math.sin(angle)
    assert signed_distance(shape, 1.000001 * shape.corner_circle * x, 1.000001 * shape.corner_circle * y) > 0.0
    corner = shape.vertices[np.argmax(np.hypot(*shape.vertices.T))]
    outermost = corner * (1.0 + shape.rounding / np.hypot(*corner)) if corner.any() else np.array([x, y]) * RADIUS
    assert np.hypot(*outermost) == pytest.approx(shape.corner_circle)
    assert signed_distance(shape, *outermost.tolist()) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("name", "circumradius", "symmetry"),
    [
        ("square", SIDE / math.sqrt(2), math.pi / 2),
        ("rectangle", math.hypot(WIDTH, DEPTH) / 2, math.pi),
        ("triangle", SIDE / math.sqrt(3), 2 * math.pi / 3),
        ("hexagon", 0.08, math.pi / 3),
        ("circle", RADIUS, 0.0),
        ("irregular", None, 2 * math.pi),
        ("base", math.hypot(0.16, 0.156), 2 * math.pi),
    ],
)
def test_corner_circle_and_symmetry(name, circumradius, symmetry):
    shape = SHAPES[name]
    assert circumradius is None or shape.corner_circle == pytest.approx(circumradius)
    assert shape.symmetry_angle == pytest.approx(symmetry)
    assert shape.is_square == (name == "square")


@every_shape
def test_outline_lies_on_it_and_goes_around_counter_clockwise(shape):
    points = outline(shape)
    assert [signed_distance(shape, *point) for point in points.tolist()] == pytest.approx(
        [0.0] * len(points), abs=1e-15
    )
    x, y = points.T
    enclosed = 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
    assert enclosed == pytest.approx(area(shape), rel=3e-3)


@pytest.mark.parametrize(
    ("name", "radius"), [("square", SIDE / 2), ("rectangle", DEPTH / 2), ("circle", RADIUS), ("base", 0.004)]
)
def test_inner_radius(name, radius):
    assert inner_radius(SHAPES[name]) == pytest.approx(radius)


def test_beyond_a_corner_the_facing_side_goes_on():
    distance, *normal = facing_side(SHAPES["square"], SIDE / 2 + 0.010, SIDE / 2 + 0.004)
    assert distance == pytest.approx(0.010)
    assert normal == [1.0, 0.0]


@pytest.mark.parametrize(
    ("name", "plate", "inertia_of_a_kilogram"),
    [
        ("square", SIDE**2, SIDE**2 / 6),
        ("rectangle", WIDTH * DEPTH, (WIDTH**2 + DEPTH**2) / 12),
        ("hexagon", 1.5 * math.sqrt(3) * 0.08**2, 5 / 12 * 0.08**2),
        ("triangle", math.sqrt(3) / 4 * SIDE**2, SIDE**2 / 12),
        ("circle", math.pi * RADIUS**2, RADIUS**2 / 2),
        ("base", 0.32 * 0.16, (0.32**2 + 0.16**2) / 12 + 0.076**2),
    ],
)
def test_area_and_inertia_of_a_plate(name, plate, inertia_of_a_kilogram):
    assert area(SHAPES[name]) == pytest.approx(plate)
    assert plate_inertia(SHAPES[name], 2.0) == pytest.approx(2.0 * inertia_of_a_kilogram)


@pytest.mark.parametrize("name", ["irregular", "rounded"])
def test_area_and_inertia_are_those_of_many_points(name):
    shape, step = SHAPES[name], 1e-3
    axis = np.arange(-0.2, 0.2, step) + step / 2
    inside = [(x, y) for x in axis for y in axis if signed_distance(shape, float(x), float(y)) < 0.0]
    assert area(shape) == pytest.approx(len(inside) * step**2, rel=5e-3)
    assert plate_inertia(shape, 1.0) == pytest.approx(np.mean([x**2 + y**2 for x, y in inside]), rel=5e-3)


def test_a_plate_about_its_centroid_balances():
    shape, step = SHAPES["irregular"], 1e-3
    axis = np.arange(-0.2, 0.2, step) + step / 2
    inside = [(x, y) for x in axis for y in axis if signed_distance(shape, float(x), float(y)) < 0.0]
    assert np.mean(inside, axis=0) == pytest.approx([0.0, 0.0], abs=2e-4)


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ([[0.1, 0.0], [-0.1, 0.0]], "there are 2"),
        ([[0.1, 0.1], [0.1, -0.1], [-0.1, -0.1], [-0.1, 0.1]], "clockwise"),
        ([[0.1, 0.0], [0.1, 0.0], [0.0, 0.1], [-0.1, -0.1]], "vertices 1 and 2 are the same point"),
        ([[0.1, 0.0], [0.0, 0.1], [-0.1, -0.1], [0.1, 0.0]], "vertices 4 and 1 are the same point"),
        ([[0.1, -0.1], [0.0, 0.0], [0.1, 0.1], [-0.1, 0.0]], r"at vertex 2 \(0, 0\) the outline turns right"),
        ([[0.1, -0.1], [0.1, 0.0], [0.1, 0.1], [-0.1, 0.0]], r"vertex 2 \(0\.1, 0\) lies on the line"),
        ([[0.0, 0.1], [-0.06, -0.08], [0.1, 0.03], [-0.1, 0.03], [0.06, -0.08]], "more than once"),
    ],
    ids=["two corners", "clockwise", "a corner twice", "the first again", "a dent", "a flat corner", "a star"],
)
@pytest.mark.parametrize("made", [polygon, even_plate])
def test_what_is_no_convex_polygon_is_refused_with_what_is_wrong(made, corners, words):
    with pytest.raises(ConfigError, match=f"vertices = '.*': they are no convex polygon: .*{words}"):
        made(np.array(corners))


def test_more_corners_than_there_is_room_for_are_refused():
    with pytest.raises(ConfigError, match="13 corners: a shape has at most 12"):
        regular_polygon(13, 0.1)


def test_a_circle_without_radius_is_refused():
    with pytest.raises(ConfigError, match="rounding = 0 m"):
        circle(0.0)

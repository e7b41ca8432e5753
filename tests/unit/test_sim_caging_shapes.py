"""Cages of other shapes than the square, against known margins and an independent proof of escape.

`escapes` floods the free poses of a coarse grid. It steps between two only if both are clear of the hands, exact
capsules, by half of what the step moves any point, so that the way between is free as well: what it reaches, the
target can be led to. `cage` proves the opposite; never may both be true.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from sim.capture.caging import barred_by_both, cage, tips_enclose
from sim.compiled import FloatArray, compiled
from sim.config import ArmConfig, MissionConfig
from sim.model.clearance import hand_outline
from sim.model.planar import in_frame, rotated
from sim.model.robot import robot_model
from sim.model.shape import Shape, signed_distance
from sim.model.target import target_shape

STEP = 2.5e-3
"""Of the flood: what moves any point of the target between two poses [m]."""
AWAY = 0.30
"""Distance of the target from the hands' middle at which it has escaped [m]."""
GRID = 1.5e-3 / math.sqrt(2.0)
"""What the search takes off every margin for the positions of its grid [m]."""


class Case(NamedTuple):
    """A target, and hands from those that may cage it to those that do not."""

    config: MissionConfig
    angle: float
    """Of a target that lies between its hands as it may be caged [rad]."""
    nearest: float
    """Distance of a hand's centre from the middle between the hands [m]."""
    farthest: float


CASES = {
    "circle": Case(MissionConfig.model_validate({"target": {"shape": "circle", "radius": 0.075}}), 0.0, 0.081, 0.096),
    "hexagon": Case(
        MissionConfig.model_validate({"target": {"shape": "regular_polygon", "sides": 6, "side": 0.08}}),
        math.pi / 6,
        0.074,
        0.086,
    ),
    "rectangle": Case(
        MissionConfig.model_validate({"target": {"shape": "rectangle", "width": 0.09, "depth": 0.045}}), 0.0, 0.03, 0.06
    ),
    "wedge": Case(
        MissionConfig.model_validate(
            {"target": {"shape": "polygon", "vertices": [[0.0, 0.0], [0.14, 0.0], [0.11, 0.10], [0.0, 0.13]]}}
        ),
        2.4,
        0.072,
        0.086,
    ),
}
every_case = pytest.mark.parametrize("case", CASES.values(), ids=CASES)
ROBOT = robot_model(MissionConfig().robot)
TIP = ROBOT.tip_radius


def facing(distance: float) -> FloatArray:
    """Both hands facing each other across the origin, shape (2, 3)."""
    return np.array([[-distance, 0.0, -math.pi / 2], [distance, 0.0, math.pi / 2]])


@pytest.mark.parametrize("distance", [0.082, 0.086, 0.095])
def test_a_circle_needs_the_gap_between_opposite_tips_to_widen_to_its_diameter(distance: float) -> None:
    found = cage(CASES["circle"].config, facing(distance), np.zeros(3))
    assert found.margin == pytest.approx(0.075 + TIP - distance - GRID, abs=5e-5)


@pytest.mark.parametrize("distance", [0.076, 0.080, 0.090])
@pytest.mark.parametrize("angle", [0.0, -2.0 * math.pi / 3.0])
def test_a_hexagon_needs_it_to_widen_to_its_width_across_flats(distance: float, angle: float) -> None:
    found = cage(CASES["hexagon"].config, facing(distance), np.array([0.0, 0.0, angle]))
    turning = 0.5 * math.radians(1.0) * 0.08
    assert found.margin == pytest.approx(0.04 * math.sqrt(3.0) + TIP - distance - GRID - turning, abs=2e-4)


@pytest.mark.parametrize(("distance", "caged"), [(0.032, True), (0.036, True), (0.050, False)])
def test_a_rectangle_lying_in_both_hands(distance: float, caged: bool) -> None:
    assert cage(CASES["rectangle"].config, facing(distance), np.zeros(3)).caged == caged


@every_case
def test_a_turn_of_the_symmetry_angle_changes_nothing(case: Case) -> None:
    turn = target_shape(case.config.target).symmetry_angle or 0.7
    still, turned = (
        cage(case.config, facing(case.nearest), np.array([0.0, 0.0, angle])) for angle in (0.1, 0.1 + turn)
    )
    assert turned.margin == pytest.approx(still.margin, abs=1e-12)


@every_case
@pytest.mark.parametrize("poses", [60, pytest.param(1000, marks=pytest.mark.slow)])
def test_no_target_that_is_called_caged_can_be_led_out(case: Case, poses: int) -> None:
    random = np.random.default_rng(poses)
    shape, arm = target_shape(case.config.target), case.config.robot.arm
    finger = arm.hand.finger_radius
    cages = escapes = 0
    while poses > 0:
        hands = facing(random.uniform(case.nearest, case.farthest)) + random.normal(0.0, [3e-3, 3e-3, 0.05], (2, 3))
        target = np.array([*random.normal(0.0, 3e-3, 2), case.angle + random.normal(0.0, 0.2)])
        points = outlines_of(arm, hands)
        if _room(points, finger, TIP, shape, target) <= 0.0:
            continue
        poses -= 1
        caged = cage(case.config, hands, target).caged
        escaped = _escapes(points, finger, TIP, shape, target)
        assert not (caged and escaped), (hands.tolist(), target.tolist())
        cages, escapes = cages + caged, escapes + escaped
    assert min(cages, escapes) >= 5, "the poses put neither to the test"


@every_case
def test_tips_enclose_what_they_cage_between_them(case: Case) -> None:
    shape = target_shape(case.config.target)
    between, beside = np.array([0.0, 0.0, case.angle]), np.array([0.0, 0.3, case.angle])
    assert tips_enclose(ROBOT, shape, facing(case.nearest + 2e-3), between)
    assert not tips_enclose(ROBOT, shape, facing(0.15), between)
    assert not tips_enclose(ROBOT, shape, facing(case.nearest + 2e-3), beside)


@pytest.mark.parametrize("name", ["wedge", "rectangle", "circle"])
def test_two_tips_bar_a_common_place_where_their_regions_overlap(name: str) -> None:
    """They do if the way from tip to tip lies in the shape's difference body, two tip radii wider."""
    shape, random = target_shape(CASES[name].config.target), np.random.default_rng(0)
    found = 0
    for _ in range(500):
        x, y, other_x, other_y = random.uniform(-0.15, 0.15, 4)
        overlap = _overlap(shape, other_x - x, other_y - y)
        barred, place_x, place_y = barred_by_both(shape, TIP, x, y, other_x, other_y)
        assert barred or overlap < 5e-5
        assert overlap >= 0.0 or not barred
        if barred:
            found += 1
            assert signed_distance(shape, x - place_x, y - place_y) <= TIP + 1e-12
            assert signed_distance(shape, other_x - place_x, other_y - place_y) <= TIP + 1e-12
    assert 100 < found < 400, "the places do not put it to the test"


def _overlap(shape: Shape, x: float, y: float) -> float:
    """How far a vector lies within the difference body of shape and tips [m]: less its share of the support."""
    angles = np.linspace(0.0, 2.0 * math.pi, 7200, endpoint=False)
    along = np.column_stack((np.cos(angles), np.sin(angles)))
    reach = along @ shape.vertices[: shape.corners].T
    widths = reach.max(axis=1) - reach.min(axis=1) + 2.0 * (shape.rounding + TIP)
    return float((widths - along @ np.array([x, y])).min())


@pytest.mark.parametrize("sides", [3, 4, 5, 6])
def test_what_the_tips_enclose_cannot_be_led_out_without_a_turn(sides: int) -> None:
    """Also a shape that is another after half a turn, whose regions may overlap beside the middle alone."""
    random = np.random.default_rng(sides)
    config = MissionConfig.model_validate(
        {"target": {"shape": "regular_polygon", "sides": sides, "side": 0.36 / sides}}
    )
    unturned, arm = target_shape(config.target)._replace(symmetry_angle=0.0), config.robot.arm
    enclosed = 0
    for _ in range(4000):
        hands = facing(random.uniform(0.04, 0.09)) + random.normal(0.0, [3e-3, 3e-3, 0.05], (2, 3))
        target = np.array([*random.normal(0.0, 0.01, 2), random.uniform(-math.pi, math.pi)])
        if tips_enclose(ROBOT, unturned, hands, target):
            enclosed += 1
            points = outlines_of(arm, hands)
            assert not _escapes(points, arm.hand.finger_radius, TIP, unturned, target), (
                hands.tolist(),
                target.tolist(),
            )
    assert enclosed >= 5, "the poses do not put it to the test"


def outlines_of(arm: ArmConfig, hands: FloatArray) -> FloatArray:
    """Finger, palm and finger of both hands in the world [m], shape (2, 4, 2)."""
    return np.array([[np.array(rotated(pose[2], *point)) + pose[:2] for point in hand_outline(arm)] for pose in hands])


@compiled
def _escapes(points: FloatArray, finger: float, tip: float, shape: Shape, start: FloatArray) -> bool:
    """Whether the flood gets away from a pose, shape (3,); points of the hands' outlines, shape (2, 4, 2)."""
    turns = max(1, math.ceil(shape.symmetry_angle * shape.corner_circle / STEP))
    turn = shape.symmetry_angle / turns
    half = math.ceil(AWAY / STEP)
    visited = np.zeros((turns, 2 * half + 1, 2 * half + 1), np.bool_)
    visited[0, half, half] = True
    middle_x, middle_y = points[:, :, 0].mean(), points[:, :, 1].mean()
    stack = [(0, half, half)]
    pose = start.copy()
    if _room(points, finger, tip, shape, pose) < 0.5 * STEP:
        return False
    while len(stack) > 0:
        k, i, j = stack.pop()
        for dk, di, dj in ((0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0)):
            c, a, b = (k + dk) % turns, i + di, j + dj
            if visited[c, a, b]:
                continue
            visited[c, a, b] = True
            pose[0], pose[1] = start[0] + (a - half) * STEP, start[1] + (b - half) * STEP
            pose[2] = start[2] + c * turn
            if _room(points, finger, tip, shape, pose) < 0.5 * STEP:
                continue
            if max(abs(pose[0] - middle_x), abs(pose[1] - middle_y)) > AWAY - 0.05:
                return True
            stack.append((c, a, b))
    return False


@compiled
def _room(points: FloatArray, finger: float, tip: float, shape: Shape, pose: FloatArray) -> float:
    """Distance of the target from tips and fingers [m]: that of an end from it, or of its corner from a capsule.

    Where they overlap by more than they can in one step of the flood the answer may be above zero.
    """
    room = math.inf
    for hand in range(points.shape[0]):
        for place in range(points.shape[1]):
            x, y = in_frame(pose, points[hand, place, 0], points[hand, place, 1])
            radius = tip if place in {0, points.shape[1] - 1} else finger
            room = min(room, signed_distance(shape, x, y) - radius)
        for place in range(points.shape[1] - 1):
            ax, ay = in_frame(pose, points[hand, place, 0], points[hand, place, 1])
            bx, by = in_frame(pose, points[hand, place + 1, 0], points[hand, place + 1, 1])
            along_x, along_y = bx - ax, by - ay
            for corner in range(shape.corners):
                dx, dy = shape.vertices[corner, 0] - ax, shape.vertices[corner, 1] - ay
                part = min(max((dx * along_x + dy * along_y) / (along_x**2 + along_y**2), 0.0), 1.0)
                distance = math.hypot(dx - part * along_x, dy - part * along_y)
                room = min(room, distance - finger - shape.rounding)
    return room

"""What overlaps what before a start."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import MissionConfig, TargetShape
from sim.configurations import NAMED_CONFIGURATIONS
from sim.model.clearance import corner_overlap, corners_overlap, hand_outline, initial_overlap
from sim.model.shape import circle, rectangle


def placed(**target) -> MissionConfig:
    """The default configuration with the target elsewhere, unchecked."""
    return MissionConfig().model_copy(update={"target": MissionConfig().target.model_copy(update=target)})


@pytest.mark.parametrize("name", list(NAMED_CONFIGURATIONS))
def test_named_configurations_start_clear(name):
    assert initial_overlap(NAMED_CONFIGURATIONS[name]) is None


@pytest.mark.parametrize(
    ("target", "part"),
    [
        ({"initial_y": 0.10}, "base"),
        ({"initial_x": 0.15, "initial_y": 0.385}, "right"),
        ({"initial_x": -0.15, "initial_y": 0.385}, "left"),
        ({"initial_x": 0.30, "initial_y": 0.25}, "right link"),
        ({"initial_x": 0.1984 - 0.09 + 0.002, "initial_y": 0.385}, "right tips"),
    ],
)
def test_an_overlap_names_its_part(target, part):
    found = initial_overlap(placed(**target))
    assert found is not None
    assert found[0].startswith(part)
    assert found[1] > 0.0


def test_the_deepest_overlap_is_told_with_its_depth():
    overlap = initial_overlap(placed(initial_x=0.1984 - 0.09 + 0.002, initial_y=0.385))
    assert overlap is not None
    part, depth = overlap
    assert part == "right tips"
    assert depth == pytest.approx(0.002, abs=1e-4)


def test_a_hairs_breadth_of_room_is_clear():
    assert initial_overlap(placed(initial_x=0.1984 - 0.09 - 0.001, initial_y=0.385)) is None


def test_a_small_target_in_the_middle_of_the_base_overlaps_it():
    assert initial_overlap(placed(side=0.02, initial_x=0.0, initial_y=0.0))[0] == "base"


def test_corner_overlap_is_about_the_corners_of_the_first_only():
    small, large = rectangle(0.2, 0.2), rectangle(0.8, 1.2)
    small_pose, large_pose = np.array([0.5, 0.5, math.pi / 4]), np.zeros(3)
    assert corner_overlap(small, small_pose, large, large_pose) == pytest.approx(0.1 * math.sqrt(2.0) - 0.1)
    assert corner_overlap(large, large_pose, small, small_pose) < 0.0
    assert corners_overlap(large, large_pose, small, small_pose)
    assert corner_overlap(small, np.array([2.0, 0.0, 0.0]), large, large_pose) == -math.inf


def test_a_circle_overlaps_by_its_radius():
    disc, plate = circle(0.1), rectangle(0.8, 1.2)
    assert corner_overlap(disc, np.array([0.48, 0.3, 1.0]), plate, np.zeros(3)) == pytest.approx(0.02)
    assert corners_overlap(disc, np.array([0.459, 0.679, 0.0]), plate, np.zeros(3))  # 0.098 from the corner
    assert not corners_overlap(disc, np.array([0.461, 0.681, 0.0]), plate, np.zeros(3))


@pytest.mark.parametrize(
    ("target", "part"),
    [
        ({"shape": TargetShape.CIRCLE, "radius": 0.12, "initial_y": 0.2}, None),
        ({"shape": TargetShape.CIRCLE, "radius": 0.125, "initial_y": 0.2}, "base"),
        ({"shape": TargetShape.RECTANGLE, "width": 0.1, "depth": 0.24, "initial_y": 0.2}, None),
        ({"shape": TargetShape.RECTANGLE, "width": 0.1, "depth": 0.25, "initial_y": 0.2}, "base"),
        ({"shape": TargetShape.REGULAR_POLYGON, "sides": 6, "side": 0.119, "initial_y": 0.2}, None),
        ({"shape": TargetShape.REGULAR_POLYGON, "sides": 6, "side": 0.121, "initial_y": 0.2}, "base"),
        # The centroid of a right triangle is a third of its height above its base: 0.119 m clear, 0.121 m not.
        ({"shape": TargetShape.POLYGON, "vertices": ((0, 0), (0.1, 0), (0, 0.357)), "initial_y": 0.2}, None),
        ({"shape": TargetShape.POLYGON, "vertices": ((0, 0), (0.1, 0), (0, 0.363)), "initial_y": 0.2}, "base"),
    ],
)
def test_any_shape_is_held_against_the_robot(target, part):
    found = initial_overlap(placed(**target))
    assert (None if found is None else found[0]) == part


def test_hand_is_a_u_between_its_tips():
    arm = MissionConfig().robot.arm
    outline = hand_outline(arm)
    assert outline[[0, 3], 1].tolist() == [0.0, 0.0]
    assert outline[[1, 2], 1] == pytest.approx(-arm.hand.centre_offset)
    assert outline[3, 0] - outline[0, 0] == pytest.approx(2 * arm.hand.tip_offset)

"""What overlaps what before a start."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import MissionConfig
from sim.configurations import NAMED_CONFIGURATIONS
from sim.model.clearance import corner_inside, hand_outline, initial_overlap


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


def test_corner_inside_sees_one_corner_of_the_first_only():
    small, large = np.array([0.5, 0.5, math.pi / 4]), np.zeros(3)
    assert corner_inside(small, 0.1, 0.1, large, 0.4, 0.6)
    assert not corner_inside(large, 0.4, 0.6, small, 0.1, 0.1)
    assert not corner_inside(np.array([2.0, 0.0, 0.0]), 0.1, 0.1, large, 0.4, 0.6)


def test_hand_is_a_u_between_its_tips():
    arm = MissionConfig().robot.arm
    outline = hand_outline(arm)
    assert outline[[0, 3], 1].tolist() == [0.0, 0.0]
    assert outline[[1, 2], 1] == pytest.approx(-arm.hand.centre_offset)
    assert outline[3, 0] - outline[0, 0] == pytest.approx(2 * arm.hand.tip_offset)

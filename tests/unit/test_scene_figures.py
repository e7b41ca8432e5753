"""Geometry of the scene against formulas of its own."""

import math

import numpy as np
import pytest

from server.scene.figures import (
    Trail,
    arm_places,
    base_place,
    closed_outline,
    dashed_line,
    manipulability_ellipse,
    raised,
    tip_points,
)
from sim.capture.mission import Mission
from sim.config import MissionConfig

ROUNDING = 1e-12
JOINT_DRIFT = 1e-6
"""What the physics engine lets joints gape [m]."""
ROBOT = MissionConfig().robot


def composed(places):
    """The last of a chain of frames, as a complex position and an angle."""
    position, angle = 0j, 0.0
    for x, y, turn in places:
        position += complex(x, y) * np.exp(1j * angle)
        angle += turn
    return position, angle


@pytest.mark.parametrize("arm", [0, 1])
@pytest.mark.parametrize("joints", [(1.0, -1.1, -1.5), (0.0, 0.0, 0.0), (-2.0, 0.4, 3.0)])
def test_an_arm_hangs_together_as_the_sum_of_its_links(arm, joints):
    places = arm_places(ROBOT, arm, joints, 0.07)
    reach = ROBOT.arm.hand.centre_offset
    position, angle = composed([*places, (0.0, reach, 0.0)])
    turns = np.cumsum([*joints, 0.07])
    lengths = np.array([0.250, 0.180, 0.13655, reach])
    x = (-1, 1)[arm] * 0.160 - lengths @ np.sin(turns)
    y = 0.080 + lengths @ np.cos(turns)
    assert position == pytest.approx(complex(x, y), abs=ROUNDING)
    assert angle == pytest.approx(turns[-1], abs=ROUNDING)


def test_a_drawn_hand_is_where_the_mission_says():
    mission = Mission(MissionConfig())
    mission.advance(1)
    snapshot = mission.snapshot()
    base = base_place(snapshot.base.pose, ROBOT.base.centre_of_mass_ahead)
    for arm, state in enumerate((snapshot.left, snapshot.right)):
        places = arm_places(ROBOT, arm, state.joint_angle, state.mount_angle)
        position, _ = composed([base, *places, (0.0, ROBOT.arm.hand.centre_offset, 0.0)])
        assert (position.real, position.imag) == pytest.approx(state.hand_pose[:2], abs=JOINT_DRIFT)


def test_the_arms_start_as_mirror_images():
    joints = (math.radians(60), math.radians(-60), math.radians(-90))
    left, _ = composed(arm_places(ROBOT, 0, joints, 0.1))
    right, _ = composed(arm_places(ROBOT, 1, [-angle for angle in joints], -0.1))
    assert right == pytest.approx(-left.conjugate(), abs=ROUNDING)


def test_the_base_is_drawn_about_its_geometric_centre():
    assert base_place((0.0, 0.076078, 0.0), 0.076078) == pytest.approx((0.0, 0.0, 0.0))
    x, y, _ = base_place((1.0, 2.0, math.pi / 2), 0.5)
    assert (x, y) == pytest.approx((1.5, 2.0))


def test_tips_lie_across_the_hand():
    tips = tip_points((0.1, 0.2, math.pi / 2), 0.04)
    assert tips == pytest.approx(np.array([[0.1, 0.16], [0.1, 0.24]]))


@pytest.mark.parametrize("elbow", [-2.5, -1.0, 0.2, 1.3, 3.0])
def test_the_ellipse_bounds_the_wrist_velocities_of_unit_joint_rates(elbow):
    """Wrist velocities by central differences of the chain, seen from link 2, all lie on the ellipse."""
    major, minor, angle = manipulability_ellipse(0.250, 0.180, elbow)
    assert major * minor == pytest.approx(0.250 * 0.180 * abs(math.sin(elbow)), abs=ROUNDING)

    def wrist(first, second):
        return 0.250j * np.exp(1j * first) + 0.180j * np.exp(1j * (first + second))

    step = 1e-6
    by_first = (wrist(step, elbow) - wrist(-step, elbow)) / (2 * step)
    by_second = (wrist(0.0, elbow + step) - wrist(0.0, elbow - step)) / (2 * step)
    for direction in np.linspace(0.0, 2 * math.pi, 17):
        velocity = math.cos(direction) * by_first + math.sin(direction) * by_second
        along = velocity * np.exp(-1j * (elbow + angle))
        assert (along.real / major) ** 2 + (along.imag / minor) ** 2 == pytest.approx(1.0, abs=1e-6)


def test_the_ellipse_is_flat_at_a_singularity():
    assert manipulability_ellipse(0.250, 0.180, 0.0).minor == pytest.approx(0.0, abs=ROUNDING)


def test_dashes_cover_their_share_and_stay_on_the_line():
    line = raised(np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1]]), 0.5)
    dashes = dashed_line(line, 0.02, 0.02)
    assert dashes.shape == (10, 2, 3)
    assert np.linalg.norm(dashes[:, 1] - dashes[:, 0], axis=1) == pytest.approx(np.full(10, 0.02))
    assert np.all(dashes[..., 2] == 0.5)
    assert len(dashed_line(line[[0, 0]], 0.02, 0.02)) == 0


def test_an_outline_goes_around_once():
    corners = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
    x, y = closed_outline(corners).T
    area = np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) / 2
    assert area == pytest.approx(1.0)


def test_a_trail_is_bounded_and_keeps_its_shape():
    trail = Trail(capacity=10, spacing=0.01)
    assert trail.extend(0.0, 0.0)
    assert not trail.extend(0.009, 0.0)
    shape = trail.segments(0.0).shape
    for step in range(1, 100):
        assert trail.extend(0.0101 * step, 0.0)
    segments = trail.segments(0.0)
    assert segments.shape == shape == (10, 2, 3)
    assert segments[-1, 1, 0] == pytest.approx(0.0101 * 99)
    trail.clear()
    trail.extend(5.0, 5.0)
    assert np.ptp(trail.segments(0.0), axis=(0, 1)) == pytest.approx(np.zeros(3))

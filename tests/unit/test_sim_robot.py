"""The link chain: numbers of the published robot, and properties of any."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import MissionConfig, RobotConfig
from sim.configurations import nested, revised
from sim.model.clearance import initial_base_pose
from sim.model.robot import FREEDOMS, base_shape, chain, freedom, initial_joint_angles, robot_model, tip_position

CONFIG = RobotConfig()
ROBOT = robot_model(CONFIG)
START = chain(ROBOT, initial_base_pose(MissionConfig()), initial_joint_angles(CONFIG.arm), np.zeros(2))
PRINTED = 5e-5
"""Half of the last digit that the method's document gives."""


def test_whole_robot_weighs_what_the_document_says():
    assert ROBOT.total_mass == pytest.approx(11.2814, abs=PRINTED)


def test_link_3_and_hand_together_are_the_third_row_of_table_i():
    mass = ROBOT.link_mass[2:].sum()
    hand_centre = CONFIG.arm.link_3.length + CONFIG.arm.hand.centre_of_mass
    centre = (ROBOT.link_mass[2] * ROBOT.link_centre[2] + ROBOT.link_mass[3] * hand_centre) / mass
    inertia = ROBOT.link_inertia[2:].sum()
    inertia += (
        ROBOT.link_mass[2] * (ROBOT.link_centre[2] - centre) ** 2 + ROBOT.link_mass[3] * (hand_centre - centre) ** 2
    )
    assert mass == pytest.approx(0.2067, abs=PRINTED)
    assert centre == pytest.approx(0.09275, abs=PRINTED)
    assert inertia == pytest.approx(6.866e-4, abs=1e-6)


def test_shoulders_stand_at_the_front_corners_of_the_base():
    assert ROBOT.shoulder_in_base == pytest.approx(np.array([[-0.160, 0.003922], [0.160, 0.003922]]), abs=1e-6)


def test_hands_start_where_the_document_says_palms_facing():
    assert pytest.approx(np.array([[-0.1984, 0.385], [0.1984, 0.385]]), abs=PRINTED) == START.hand_pose[:, :2]
    assert pytest.approx([-math.pi / 2, math.pi / 2]) == START.hand_pose[:, 2]


def test_base_starts_with_its_rectangle_on_the_origin():
    config = MissionConfig()
    x, y, angle = initial_base_pose(config)
    corners = base_shape(config.robot.base).vertices[:4] + np.array([x, y])
    assert angle == 0.0
    assert corners.mean(axis=0) == pytest.approx([0.0, 0.0])
    assert np.ptp(corners, axis=0) == pytest.approx([0.32, 0.16])


def test_arms_mirror_each_other_at_the_start():
    mirror = np.array([-1.0, 1.0])
    assert START.joint[1] == pytest.approx(START.joint[0] * mirror)
    assert START.centre[1] == pytest.approx(START.centre[0] * mirror)


def test_stretched_arm_reaches_its_whole_length():
    links = chain(ROBOT, np.zeros(3), np.zeros((2, 3)), np.zeros(2))
    for arm in range(2):
        reach = links.hand_pose[arm, :2] - links.joint[arm, 0]
        assert reach == pytest.approx([0.0, ROBOT.link_length.sum()])


def test_neighbouring_links_meet_at_their_joint():
    links = chain(
        ROBOT, np.array([0.1, 0.2, 0.3]), np.array([[0.5, -1.0, 0.7], [1.0, 1.0, -2.0]]), np.array([0.1, -0.1])
    )
    for arm in range(2):
        for link in range(3):
            apart = np.hypot(*(links.joint[arm, link + 1] - links.joint[arm, link]))
            assert apart == pytest.approx(ROBOT.link_length[link])


def test_freedoms_are_left_joints_right_joints_then_mounts():
    places = [freedom(arm, joint) for arm in range(2) for joint in range(3)] + [freedom(arm, 3) for arm in range(2)]
    assert places == list(range(3, FREEDOMS))


def test_tips_stand_across_the_hand_on_its_x_axis():
    hand = np.array([1.0, 2.0, math.pi / 2])
    assert tip_position(ROBOT, hand, 0) == pytest.approx((1.0, 2.0 - CONFIG.arm.hand.tip_offset))
    assert tip_position(ROBOT, hand, 1) == pytest.approx((1.0, 2.0 + CONFIG.arm.hand.tip_offset))


def test_the_model_follows_its_configuration():
    config = revised(MissionConfig(), nested({"robot.arm.link_2.length": 0.2, "robot.base.width": 0.4})).robot
    robot = robot_model(config)
    assert robot.link_length[1] == 0.2
    assert robot.shoulder_in_base[:, 0].tolist() == [-0.2, 0.2]

"""What overlaps what: the target's square against the robot's base, links and hands."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import ArmConfig, MissionConfig
from sim.model.planar import rotated
from sim.model.robot import JOINTS, RobotModel, chain, initial_joint_angles, robot_model
from sim.model.target import distance_from_square, in_target

_SAMPLES = 41  # along a link, for the check before a start: every few millimetres


@compiled
def corner_inside(
    pose: FloatArray, half_x: float, half_y: float, other: FloatArray, other_x: float, other_y: float
) -> bool:
    """Whether a corner of the first rectangle lies inside the other; poses of their centres, shape (3,) [m, rad]."""
    reach = math.hypot(half_x, half_y) + math.hypot(other_x, other_y)
    if math.hypot(pose[0] - other[0], pose[1] - other[1]) > reach:
        return False
    for i in range(4):
        dx, dy = rotated(pose[2], half_x if i in {0, 3} else -half_x, half_y if i < 2 else -half_y)
        x, y = in_target(other, pose[0] + dx, pose[1] + dy)
        if abs(x) <= other_x and abs(y) <= other_y:
            return True
    return False


def geometric_base_pose(config: MissionConfig, base_pose: FloatArray) -> FloatArray:
    """Pose of the base's rectangle from that of its centre of mass, shape (3,) [m, rad]."""
    dx, dy = rotated(float(base_pose[2]), 0.0, -config.robot.base.centre_of_mass_ahead)
    return np.array([base_pose[0] + dx, base_pose[1] + dy, base_pose[2]])


def initial_base_pose(config: MissionConfig) -> FloatArray:
    """Pose of the base's centre of mass at the start, shape (3,): its rectangle is centred on the world's origin."""
    return np.array([0.0, config.robot.base.centre_of_mass_ahead, 0.0])


def initial_target_pose(config: MissionConfig) -> FloatArray:
    """Pose of the target's centre at the start, shape (3,) [m, rad]."""
    return np.array([config.target.initial_x, config.target.initial_y, config.target.initial_angle])


def hand_outline(arm: ArmConfig) -> FloatArray:
    """Centre line of the U-shaped hand in its own frame: finger, palm, finger [m], shape (4, 2)."""
    half, depth = arm.hand.tip_offset, arm.hand.centre_offset
    return np.array([[-half, 0.0], [-half, -depth], [half, -depth], [half, 0.0]])


def initial_overlap(config: MissionConfig) -> tuple[str, float] | None:
    """The part of the robot that the target overlaps most at the start and how deep [m], or None."""
    target = initial_target_pose(config)
    half_side = config.target.side / 2
    depths = dict(_hand_and_link_depths(config, target, half_side))
    base = geometric_base_pose(config, initial_base_pose(config))
    half_x, half_y = config.robot.base.width / 2, config.robot.base.depth / 2
    if corner_inside(target, half_side, half_side, base, half_x, half_y) or corner_inside(
        base, half_x, half_y, target, half_side, half_side
    ):
        depths["base"] = half_side + half_y - abs(target[1] - base[1])
    part = max(depths, key=lambda name: depths[name])
    return (part, depths[part]) if depths[part] > 0.0 else None


def _hand_and_link_depths(config: MissionConfig, target: FloatArray, half_side: float) -> list[tuple[str, float]]:
    arm_config = config.robot.arm
    robot: RobotModel = robot_model(config.robot)
    links = chain(robot, initial_base_pose(config), initial_joint_angles(arm_config), np.zeros(2))
    depths = []
    for arm, side in enumerate(("left", "right")):
        hand = links.hand_pose[arm]
        outline = np.array([hand[:2] + np.array(rotated(hand[2], *point)) for point in hand_outline(arm_config)])
        for j in range(JOINTS):
            run = links.joint[arm, j : j + 2]
            depths.append((f"{side} link {j + 1}", _depth(run, arm_config.link_radius, target, half_side)))
        depths.append((f"{side} hand", _depth(outline, arm_config.hand.finger_radius, target, half_side)))
        tips = outline[[0, 3]]
        depths.append(
            (f"{side} tips", max(_depth(tips[[i, i]], robot.tip_radius, target, half_side) for i in range(2)))
        )
    return depths


def _depth(run: FloatArray, radius: float, target: FloatArray, half_side: float) -> float:
    """How deep [m] a chain of capsules along these points, shape (n, 2), reaches into the target; negative if clear."""
    deepest = -math.inf
    for start, end in pairwise(run):
        for part in np.linspace(0.0, 1.0, _SAMPLES):
            x, y = in_target(target, *(start + part * (end - start)))
            deepest = max(deepest, radius - distance_from_square(half_side, x, y))
    return deepest

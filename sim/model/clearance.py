"""What overlaps what: the target against the robot's base, links and hands."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.config import ArmConfig, MissionConfig
from sim.model.planar import in_frame, rotated
from sim.model.robot import JOINTS, base_shape, chain, initial_joint_angles, robot_model
from sim.model.shape import Shape, signed_distance
from sim.model.target import seen_target_shape, target_shape
from sim.record import Record, packed

_SAMPLES = 41  # along a link, for the check before a start: every few millimetres


class Shapes(NamedTuple):
    """What may overlap by a corner; compiled code reads it as a record."""

    base: Shape
    target: Shape
    """About its centre of mass: where it truly is."""
    seen_target: Shape
    """About its middle: as it is perceived."""


def shapes_of(config: MissionConfig) -> Record:
    """The `Shapes` of a configuration, packed: compiled code hands a record on as one address, five times as fast."""
    target = config.target
    return packed(Shapes(base_shape(config.robot.base), target_shape(target), seen_target_shape(target)))[0]


@compiled
def corner_overlap(shape: Shape, pose: FloatArray, other: Shape, other_pose: FloatArray) -> float:
    """How deep the deepest corner of a shape lies in another [m]; zero or less if none does.

    A rounded corner counts with its rounding. Beyond the reach of both the answer is minus infinity.

    Args:
        shape: whose corners.
        pose: of its frame, shape (3,) [m, rad].
        other: the shape that they may lie in.
        other_pose: of its frame, shape (3,) [m, rad].

    """
    deepest = -math.inf
    if math.hypot(pose[0] - other_pose[0], pose[1] - other_pose[1]) > shape.corner_circle + other.corner_circle:
        return deepest
    for corner in range(shape.corners):
        dx, dy = rotated(pose[2], shape.vertices[corner, 0], shape.vertices[corner, 1])
        x, y = in_frame(other_pose, pose[0] + dx, pose[1] + dy)
        deepest = max(deepest, shape.rounding - signed_distance(other, x, y))
    return deepest


@compiled_inline
def corners_overlap(shape: Shape, pose: FloatArray, other: Shape, other_pose: FloatArray) -> bool:
    """Whether a corner of one of two shapes lies in the other; poses of their frames, shape (3,) [m, rad]."""
    apart_x, apart_y = pose[0] - other_pose[0], pose[1] - other_pose[1]
    overlapping = shape.corner_circle + other.corner_circle
    if apart_x * apart_x + apart_y * apart_y > overlapping * overlapping:
        return False
    return _corners_overlap_nearby(shape, pose, other, other_pose)


@compiled
def _corners_overlap_nearby(shape: Shape, pose: FloatArray, other: Shape, other_pose: FloatArray) -> bool:
    """`corners_overlap` of shapes whose corner circles overlap."""
    x, y = in_frame(other_pose, pose[0], pose[1])
    if signed_distance(other, x, y) > shape.corner_circle:
        return False
    return bool(
        corner_overlap(shape, pose, other, other_pose) >= 0.0 or corner_overlap(other, other_pose, shape, pose) >= 0.0
    )


def initial_base_pose(config: MissionConfig) -> FloatArray:
    """Pose of the base's centre of mass at the start, shape (3,): its rectangle is centred on the world's origin."""
    return np.array([0.0, config.robot.base.centre_of_mass_ahead, 0.0])


def initial_target_pose(config: MissionConfig) -> FloatArray:
    """Pose of the target's centre of mass at the start, shape (3,) [m, rad]."""
    return np.array([config.target.initial_x, config.target.initial_y, config.target.initial_angle])


def hand_outline(arm: ArmConfig) -> FloatArray:
    """Centre line of the U-shaped hand in its own frame: finger, palm, finger [m], shape (4, 2)."""
    half, depth = arm.hand.tip_offset, arm.hand.centre_offset
    return np.array([[-half, 0.0], [-half, -depth], [half, -depth], [half, 0.0]])


def initial_overlap(config: MissionConfig) -> tuple[str, float] | None:
    """The part of the robot that the target overlaps most at the start and how deep [m], or None."""
    pose, base_pose, shapes = initial_target_pose(config), initial_base_pose(config), shapes_of(config)
    base, target = shapes["base"], shapes["target"]
    depths = dict(_hand_and_link_depths(config, pose, target))
    depths["base"] = max(corner_overlap(target, pose, base, base_pose), corner_overlap(base, base_pose, target, pose))
    part = max(depths, key=lambda name: depths[name])
    return (part, depths[part]) if depths[part] > 0.0 else None


def _hand_and_link_depths(config: MissionConfig, target_pose: FloatArray, shape: Shape) -> list[tuple[str, float]]:
    arm_config, robot = config.robot.arm, robot_model(config.robot)
    links = chain(robot, initial_base_pose(config), initial_joint_angles(arm_config), np.zeros(2))
    depths = []
    for arm, side in enumerate(("left", "right")):
        hand = links.hand_pose[arm]
        outline = np.array([hand[:2] + np.array(rotated(hand[2], *point)) for point in hand_outline(arm_config)])
        for j in range(JOINTS):
            run = np.ascontiguousarray(links.joint[arm, j : j + 2])
            depths.append((f"{side} link {j + 1}", _depth(run, arm_config.link_radius, target_pose, shape)))
        depths.append((f"{side} hand", _depth(outline, arm_config.hand.finger_radius, target_pose, shape)))
        tips = outline[[0, 3]]
        depths.append(
            (f"{side} tips", max(_depth(tips[[i, i]], robot.tip_radius, target_pose, shape) for i in range(2)))
        )
    return depths


@compiled
def _depth(run: FloatArray, radius: float, target_pose: FloatArray, shape: Shape) -> float:
    """How deep [m] a chain of capsules along these points, shape (n, 2), reaches into the target; negative if clear."""
    deepest = -math.inf
    for place in range(run.shape[0] - 1):
        x, y = run[place, 0], run[place, 1]
        along_x, along_y = run[place + 1, 0] - x, run[place + 1, 1] - y
        for sample in range(_SAMPLES):
            part = sample / (_SAMPLES - 1)
            u, v = in_frame(target_pose, x + part * along_x, y + part * along_y)
            deepest = max(deepest, radius - signed_distance(shape, u, v))
    return deepest

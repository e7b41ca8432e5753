"""How far the target is from the robot, by the readings: near it a touch may go unfelt, and free flight is not sure."""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.model.clearance import corner_overlap, hand_outline, shapes_of
from sim.model.planar import in_frame, rotated
from sim.model.robot import JOINTS, RobotModel, chain, robot_model
from sim.model.shape import Shape, signed_distance
from sim.record import Record, packed

NEAR = 0.012
"""Below this the target may touch the robot without a wrist feeling it [m]."""

EVERY = 4
"""Of so many rows one is looked at."""

_SAMPLES = 13
"""Along a link or finger: every two centimetres."""


def is_near(
    config: MissionConfig, base_pose: FloatArray, joint_angle: FloatArray, target_pose: FloatArray
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether a part of the robot is nearer to the target than `NEAR`, shape (rows,).

    Args:
        config: of robot and target.
        base_pose: shape (rows, 3); what was not seen is interpolated.
        joint_angle: shape (rows, 2, 3).
        target_pose: shape (rows, 3).

    """
    rows = slice(None, None, EVERY)
    base, target = (_filled(pose)[rows].copy() for pose in (base_pose, target_pose))
    angle = _filled(joint_angle.reshape(len(joint_angle), 6))[rows].reshape(-1, 2, 3).copy()
    clear = np.empty(len(base))
    arm, robot = config.robot.arm, packed(robot_model(config.robot))[0]
    _clearances(robot, shapes_of(config), hand_outline(arm), arm.link_radius, base, angle, target, clear)
    near: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = np.repeat(clear < NEAR, EVERY)[: len(base_pose)]
    return near


def _filled(values: FloatArray) -> FloatArray:
    """With straight lines over what is not a number, shape (rows, columns); zero where nothing is known."""
    result = values.copy()
    places = np.arange(len(values))
    for column in range(values.shape[1]):
        known = np.isfinite(values[:, column])
        result[:, column] = np.interp(places, places[known], values[known, column]) if known.any() else 0.0
    return result


@compiled
def _clearances(
    robot: RobotModel,
    shapes: Record,
    outline: FloatArray,
    link_radius: float,
    base_pose: FloatArray,
    joint_angle: FloatArray,
    target_pose: FloatArray,
    clear: FloatArray,
) -> None:
    """The least distance of the target from the robot [m] in each row, into `clear`; fingers are as thick as tips."""
    for row in range(len(clear)):
        links, least = chain(robot, base_pose[row], joint_angle[row], np.zeros(2)), math.inf
        for arm in range(2):
            for link in range(JOINTS):
                start, end = links.joint[arm, link], links.joint[arm, link + 1]
                first = 0.3 if link == 0 else 0.0  # the base bars the way to what is nearer the shoulder
                gap = _gap(shapes.seen_target, target_pose[row], start, end, first)
                least = min(least, gap - link_radius)
            hand = links.hand_pose[arm]
            for side in range(3):
                ends = np.empty((2, 2))
                for end_place in range(2):
                    x, y = rotated(hand[2], outline[side + end_place, 0], outline[side + end_place, 1])
                    ends[end_place, 0], ends[end_place, 1] = hand[0] + x, hand[1] + y
                least = min(least, _gap(shapes.seen_target, target_pose[row], ends[0], ends[1], 0.0) - robot.tip_radius)
        least = min(least, -corner_overlap(shapes.seen_target, target_pose[row], shapes.base, base_pose[row]))
        clear[row] = min(least, -corner_overlap(shapes.base, base_pose[row], shapes.seen_target, target_pose[row]))


@compiled
def _gap(shape: Shape, pose: FloatArray, start: FloatArray, end: FloatArray, first: float) -> float:
    """The least distance of a line's samples from the target [m]."""
    least = math.inf
    for sample in range(_SAMPLES):
        part = first + (1.0 - first) * sample / (_SAMPLES - 1)
        u, v = in_frame(pose, start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1]))
        least = min(least, signed_distance(shape, u, v))
    return least

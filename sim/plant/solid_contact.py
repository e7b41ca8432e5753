"""Base, links and hands of the robot as solids against the target: where they overlap and how deep.

A pair of convex solids that overlap by a little does so at corners of one in the other: ends of a capsule in the
target, corners of the target in a capsule's side, corners of base and target in each other.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.model.clearance import hand_outline
from sim.model.planar import sign
from sim.model.robot import JOINTS, RobotModel
from sim.model.target import TargetModel


class Solids(NamedTuple):
    """Sizes of the solids, and how near the target's centre must be for a contact."""

    base_ahead: float
    """Centre of mass of the base ahead of its rectangle's centre [m]."""
    link_radius: float
    link_1_start: float
    """Link 1 is solid from there on [m]."""
    finger_radius: float
    outline: FloatArray
    """Centre line of a hand, in its frame [m], shape (4, 2)."""
    base_reach: float
    """Distance of the target's centre from that of the base's rectangle beyond which nothing touches [m]."""
    link_reach: FloatArray
    """... from the middle of each link, shape (3,)."""
    hand_reach: float
    """... from a hand's centre, tips included."""


def solids(config: MissionConfig, robot: RobotModel, target: TargetModel) -> Solids:
    """The solids of a configured robot against a configured target."""
    arm, base = config.robot.arm, config.robot.base
    outline = hand_outline(arm)
    hand = max(float(np.hypot(*outline.T).max()) + arm.hand.finger_radius, robot.tip_offset + robot.tip_radius)
    return Solids(
        base_ahead=base.centre_of_mass_ahead,
        link_radius=arm.link_radius,
        link_1_start=arm.shoulder_clearance,
        finger_radius=arm.hand.finger_radius,
        outline=outline,
        base_reach=math.hypot(base.width, base.depth) / 2 + target.shape.corner_circle,
        link_reach=robot.link_length[:JOINTS] / 2 + arm.link_radius + target.shape.corner_circle,
        hand_reach=hand + target.shape.corner_circle,
    )


@compiled
def depth_in_capsule_side(
    start_x: float, start_y: float, end_x: float, end_y: float, radius: float, x: float, y: float
) -> tuple[float, float, float]:
    """Depth [m] of a point in a capsule between its ends, and the outward normal there; beside an end: -radius."""
    along_x, along_y = end_x - start_x, end_y - start_y
    length = math.sqrt(along_x * along_x + along_y * along_y)
    if length == 0.0:
        return -radius, 0.0, 0.0
    ux, uy = along_x / length, along_y / length
    dx, dy = x - start_x, y - start_y
    along = dx * ux + dy * uy
    if along <= 0.0 or along >= length:
        return -radius, 0.0, 0.0
    across = ux * dy - uy * dx
    side = sign(across)
    return radius - abs(across), -side * uy, side * ux

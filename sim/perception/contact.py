"""Contact as a wrist tells it: a force well over the noise, until it falls under half of that.

The same in the simulation with noise, in studies, in a replay and on the robot.
"""

from __future__ import annotations

from sim.compiled import FloatArray, compiled
from sim.model.planar import cross
from sim.model.robot import RobotModel, tip_position

RELEASE = 0.5
"""Part of the threshold under which a contact has ended."""


@compiled
def is_touching(touching: bool, force: float, threshold: float) -> bool:
    """Whether a hand touches, by its wrist's force and threshold [N] and whether it did before."""
    return force > (RELEASE * threshold if touching else threshold)


@compiled
def touching_tip(robot: RobotModel, hand_pose: FloatArray, wrench: FloatArray) -> int:
    """The tip whose lever explains the torque better: a wrist cannot tell where it is touched.

    Args:
        robot: for the tips.
        hand_pose: shape (3,), world.
        wrench: on the hand about its centre, world axes (fx, fy [N], torque [N m]), shape (3,).

    """
    best, least = 0, 0.0
    for tip in range(2):
        x, y = tip_position(robot, hand_pose, tip)
        error = abs(cross(x - hand_pose[0], y - hand_pose[1], wrench[0], wrench[1]) - wrench[2])
        if tip == 0 or error < least:
            best, least = tip, error
    return best

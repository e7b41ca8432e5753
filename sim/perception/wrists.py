"""What the wrists feel, made usable: zeroed while nothing can be touching, and smoothed.

A wrist's bias drifts after it was last tared. While a hand is too far from the target to touch it, what its wrist reads
is that bias, and its running mean is subtracted from then on. A little force is a contact only where a tip is near the
target: elsewhere it is noise, and a hand that took it for a touch would begin to press in the air.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.model.planar import in_frame, rotated
from sim.model.robot import RobotModel, tip_position
from sim.model.shape import Shape, signed_distance
from sim.record import Record

_FAR = 0.02
"""A hand whose tips are that far from the target [m] touches nothing."""
_NEAR = 0.008
"""A hand none of whose tips is that near to the target [m] cannot be what pushes a little: that is noise."""
_MEMORY = 1.0
"""Time constant of the running mean once it has lasted that long [s]."""

WRISTS = np.dtype(
    [
        ("bias", np.float64, (2, 3)),
        ("tared_for", np.float64, (2,)),  # [s]
        ("smooth", np.float64, (2, 3)),
        ("near", np.int64, (2,)),  # whether a tip may touch, as bodies are believed to be
    ],
    align=True,
)
"""What is remembered from tick to tick: hand's axes, because a bias turns with the hand."""


@compiled
def tare_and_smooth(
    wrists: Record, perception: Record, period: float, robot: RobotModel, shape: Shape, known: Record
) -> None:
    """Take this tick's wrenches, replaced in `known` by what they are without bias; `smooth` and `near` follow them.

    Args:
        wrists: one element of `WRISTS`; changed.
        perception: record of `PerceptionConfig`.
        period: control period [s].
        robot: the robot's model.
        shape: of the target.
        known: one element of `PERCEIVED`; changed.

    """
    for arm in range(2):
        pose = known.links.hand_pose[arm]
        along, across = rotated(-pose[2], known.hand_wrench[arm, 0], known.hand_wrench[arm, 1])
        reading = (along, across, known.hand_wrench[arm, 2])
        gap = _gap(robot, shape, pose, known.target_pose)
        wrists.near[arm] = gap < _NEAR
        if gap >= _FAR:
            wrists.tared_for[arm] = min(_MEMORY, wrists.tared_for[arm] + period)
            for axis in range(3):
                wrists.bias[arm, axis] += period / wrists.tared_for[arm] * (reading[axis] - wrists.bias[arm, axis])
        part = 1.0 - math.exp(-period / perception.force_smoothing_time) if perception.force_smoothing_time else 1.0
        for axis in range(3):
            clean = reading[axis] - wrists.bias[arm, axis]
            wrists.smooth[arm, axis] += part * (clean - wrists.smooth[arm, axis])
        bias_x, bias_y = rotated(pose[2], wrists.bias[arm, 0], wrists.bias[arm, 1])
        known.hand_wrench[arm, 0] -= bias_x
        known.hand_wrench[arm, 1] -= bias_y
        known.hand_wrench[arm, 2] -= wrists.bias[arm, 2]


@compiled
def smooth_wrench(wrists: Record, arm: int, angle: float, wrench: FloatArray) -> None:
    """The smoothed wrench of a hand at that angle [rad], world axes, into the wrench, shape (3,)."""
    wrench[0], wrench[1] = rotated(angle, wrists.smooth[arm, 0], wrists.smooth[arm, 1])
    wrench[2] = wrists.smooth[arm, 2]


@compiled
def _gap(robot: RobotModel, shape: Shape, hand_pose: FloatArray, target_pose: FloatArray) -> float:
    """From the nearer tip of a hand to the target [m]."""
    nearest = math.inf
    for tip in range(2):
        tip_x, tip_y = tip_position(robot, hand_pose, tip)
        x, y = in_frame(target_pose, tip_x, tip_y)
        nearest = min(nearest, signed_distance(shape, x, y) - robot.tip_radius)
    return nearest

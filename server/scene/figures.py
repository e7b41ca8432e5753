"""Lines in the plane that the scene draws, and where an arm's links stand: pure geometry.

Lengths in metres, angles in radians. Lines come as segments of shape (segments, 2, 3), the form viser takes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from server.scene.solids import FloatArray
from sim.config import RobotConfig

Place = tuple[float, float, float]
"""x, y [m] and angle [rad] of a frame in its parent's."""

SIDES = (-1.0, 1.0)
"""Sign of the shoulder's x in the base frame: left, right."""


def base_place(pose: Sequence[float], centre_of_mass_ahead: float) -> Place:
    """The base's geometric centre in the world, from the pose of its centre of mass."""
    x, y, angle = pose
    return x + centre_of_mass_ahead * math.sin(angle), y - centre_of_mass_ahead * math.cos(angle), angle


def arm_places(robot: RobotConfig, arm: int, joint_angles: Sequence[float], mount_angle: float) -> tuple[Place, ...]:
    """Links 1 to 3 and the hand of an arm, each in its parent's frame, the base's geometric centre first.

    Args:
        robot: Geometry.
        arm: 0 left, 1 right.
        joint_angles: Joints 1 to 3 [rad]; each adds to its parent's angle.
        mount_angle: Of the hand on the end of link 3 [rad].

    """
    shoulder = (SIDES[arm] * robot.base.width / 2, robot.base.depth / 2)
    first, second, third = joint_angles
    return (
        (*shoulder, first),
        (0.0, robot.arm.link_1.length, second),
        (0.0, robot.arm.link_2.length, third),
        (0.0, robot.arm.link_3.length, mount_angle),
    )


def tip_points(hand_pose: Sequence[float], tip_offset: float) -> FloatArray:
    """Centres of a hand's two tips in the world, shape (2, 2): first that towards the hand's -x."""
    x, y, angle = hand_pose
    across = tip_offset * np.array([math.cos(angle), math.sin(angle)])
    centre = np.array([x, y])
    return np.stack((centre - across, centre + across))


class Ellipse(NamedTuple):
    """Semi-axes, and the angle of the first, in the frame it is drawn in."""

    major: float
    minor: float
    angle: float


def manipulability_ellipse(first_length: float, second_length: float, second_joint: float) -> Ellipse:
    """Velocities of the wrist that joints 1 and 2 can give it at unit joint rate, in link 2's frame.

    Its area is pi times the arm's manipulability L1 L2 |sin q2|, so it thins out towards a singularity.

    Args:
        first_length: Link 1 [m].
        second_length: Link 2 [m].
        second_joint: Angle of joint 2 [rad].

    """
    sine, cosine = math.sin(second_joint), math.cos(second_joint)
    jacobian = np.array([[-first_length * cosine - second_length, -second_length], [first_length * sine, 0.0]])
    directions, gains, _ = np.linalg.svd(jacobian)
    return Ellipse(float(gains[0]), float(gains[1]), math.atan2(directions[1, 0], directions[0, 0]))


def arc_points(radius: float, start: float, sweep: float, count: int) -> FloatArray:
    """Points on an arc about the origin, shape (count, 2)."""
    angles = start + np.linspace(0.0, sweep, count)
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))


def raised(points: FloatArray, height: float) -> FloatArray:
    """Plane points (n, 2) at a height, shape (n, 3)."""
    return np.column_stack((points, np.full(len(points), height)))


def solid_line(points: FloatArray) -> FloatArray:
    """The segments between consecutive points (n, 3)."""
    return np.stack((points[:-1], points[1:]), axis=1)


def dashed_line(points: FloatArray, dash: float, gap: float) -> FloatArray:
    """Dashes of that length, with that gap, along a polyline (n, 3); a corner does not break the rhythm."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate(([0.0], np.cumsum(lengths)))
    starts = np.arange(0.0, along[-1], dash + gap)
    ends = np.minimum(starts + dash, along[-1])

    def at(distance: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(distance, along, points[:, axis]) for axis in range(3)])

    return np.stack((at(starts), at(ends)), axis=1)


def closed_outline(points: FloatArray) -> FloatArray:
    """Points (n, 2) in order of their angle about their mean, the first repeated at the end."""
    offsets = points - points.mean(axis=0)
    order = np.argsort(np.arctan2(offsets[:, 1], offsets[:, 0]))
    return points[[*order, order[0]]]


_STROKES: dict[str, tuple[tuple[tuple[float, float], ...], ...]] = {
    "0": (((0.0, 0.2), (0.3, 0.0), (0.6, 0.2), (0.6, 0.8), (0.3, 1.0), (0.0, 0.8), (0.0, 0.2)),),
    "1": (((0.1, 0.8), (0.3, 1.0), (0.3, 0.0)), ((0.1, 0.0), (0.5, 0.0))),
    ".": (((0.2, 0.0), (0.3, 0.0)),),
    "N": (((0.0, 0.0), (0.0, 1.0), (0.6, 0.0), (0.6, 1.0)),),
    "s": (((0.0, 0.1), (0.4, 0.0), (0.5, 0.17), (0.4, 0.33), (0.1, 0.37), (0.0, 0.53), (0.1, 0.7), (0.5, 0.62)),),
}


def lettering(text: str, x: float, y: float, size: float) -> list[FloatArray]:
    """Text that begins at (x, y), as the plane strokes that write it, each of shape (points, 2).

    Only the characters that the legend needs exist; a space advances.
    """
    return [
        np.array([x + 0.85 * place * size, y]) + size * np.array(stroke)
        for place, character in enumerate(text)
        for stroke in _STROKES.get(character, ())
    ]


class Trail:
    """The last stretch of a path, as points at least `spacing` apart; bounded.

    Its segments always have the same shape, so that their colours never need to be sent again.
    """

    def __init__(self, capacity: int, spacing: float) -> None:
        self.spacing = spacing
        self.points = np.zeros((capacity + 1, 2))
        self.count = 0

    def clear(self) -> None:
        """Forgets the path."""
        self.count = 0

    def extend(self, x: float, y: float) -> bool:
        """Adds a point if it is far enough from the last; whether it was."""
        if self.count and math.hypot(x - self.points[-1, 0], y - self.points[-1, 1]) < self.spacing:
            return False
        self.points[:-1] = self.points[1:]
        self.points[-1] = x, y
        if not self.count:
            self.points[:] = x, y
        self.count += 1
        return True

    def segments(self, height: float) -> FloatArray:
        """Oldest first, shape (capacity, 2, 3); those not yet there have no length."""
        return solid_line(raised(self.points, height))

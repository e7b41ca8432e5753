"""Plane geometry: rotations, angles, poses. Counter-clockwise positive, SI."""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled


@compiled
def sign(value: float) -> float:
    """+1 for zero and above, else -1: the paper's sign function (a still target counts as moving right)."""
    return 1.0 if value >= 0.0 else -1.0


@compiled
def rotated(angle: float, x: float, y: float) -> tuple[float, float]:
    """The vector (x, y) turned by an angle [rad]: from a frame at that angle into the world's axes."""
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


@compiled
def folded(angle: float, period: float) -> float:
    """The representative of an angle [rad] nearest to zero, within half a period either side."""
    return angle - period * math.floor(angle / period + 0.5)


@compiled
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """The out-of-plane component of a x b."""
    return ax * by - ay * bx


@compiled
def point_velocity(pose: FloatArray, twist: FloatArray, x: float, y: float) -> tuple[float, float]:
    """Velocity [m/s] of the body's point now at world (x, y), from its pose and twist, shape (3,)."""
    return twist[0] - twist[2] * (y - pose[1]), twist[1] + twist[2] * (x - pose[0])

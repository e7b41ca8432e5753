"""The target's shape: a square, and the distance of a point from it."""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.compiled import FloatArray, compiled
from sim.config import TargetConfig


class TargetModel(NamedTuple):
    """A square of uniform or given inertia; its centre of mass is its centre."""

    half_side: float
    mass: float
    inertia: float

    @property
    def half_diagonal(self) -> float:
        """From the centre to a corner [m]."""
        return self.half_side * math.sqrt(2.0)


def target_model(config: TargetConfig) -> TargetModel:
    """The model of a configured target."""
    return TargetModel(config.side / 2, config.mass, config.inertia)


@compiled
def in_target(target_pose: FloatArray, x: float, y: float) -> tuple[float, float]:
    """A world point in the target's frame [m]."""
    dx, dy = x - target_pose[0], y - target_pose[1]
    c, s = math.cos(target_pose[2]), math.sin(target_pose[2])
    return c * dx + s * dy, -s * dx + c * dy


@compiled
def distance_from_square(half_side: float, x: float, y: float) -> float:
    """Signed distance [m] of a point, given in the square's frame; negative inside."""
    dx, dy = abs(x) - half_side, abs(y) - half_side
    outside = math.hypot(max(dx, 0.0), max(dy, 0.0))
    return outside + min(max(dx, dy), 0.0)

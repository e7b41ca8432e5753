"""The target: its shape, mass and inertia, and a point of the world in its frame."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from sim.compiled import FloatArray, compiled
from sim.config import TargetConfig, TargetShape
from sim.model.shape import Shape, circle, rectangle, regular_polygon

SIZES: Mapping[TargetShape, tuple[str, ...]] = {
    TargetShape.SQUARE: ("side",),
    TargetShape.RECTANGLE: ("width", "depth"),
    TargetShape.REGULAR_POLYGON: ("sides", "side"),
    TargetShape.CIRCLE: ("radius",),
}
"""The parameters of `TargetConfig` that each shape's size follows from."""


class TargetModel(NamedTuple):
    """A body of some shape; its frame's origin is its centre of mass."""

    shape: Shape
    mass: float
    """[kg]"""
    inertia: float
    """About the centre of mass [kg m2]."""


def target_model(config: TargetConfig) -> TargetModel:
    """The model of a configured target."""
    return TargetModel(target_shape(config), config.mass, config.inertia)


def target_shape(config: TargetConfig) -> Shape:
    """The shape of a configured target."""
    match config.shape:
        case TargetShape.SQUARE:
            return rectangle(config.side, config.side)
        case TargetShape.RECTANGLE:
            return rectangle(config.width, config.depth)
        case TargetShape.REGULAR_POLYGON:
            return regular_polygon(config.sides, config.side)
        case TargetShape.CIRCLE:
            return circle(config.radius)


@compiled
def in_target(target_pose: FloatArray, x: float, y: float) -> tuple[float, float]:
    """A world point in the target's frame [m]."""
    dx, dy = x - target_pose[0], y - target_pose[1]
    c, s = math.cos(target_pose[2]), math.sin(target_pose[2])
    return c * dx + s * dy, -s * dx + c * dy

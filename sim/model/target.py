"""The target: its shape, mass and inertia, and where its centre of mass lies.

Two frames have the target's axes: that of its centre of mass, in which plants move it and whose pose the true state
has, and that of its middle, the centroid of its outline, which motion capture sees and whose pose is perceived. They
are one unless `target.centre_of_mass_x` and `_y` say otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import TargetConfig, TargetShape
from sim.model.planar import rotated
from sim.model.shape import Shape, circle, even_plate, moved, rectangle, regular_polygon
from sim.record import Record

SIZES: Mapping[TargetShape, tuple[str, ...]] = {
    TargetShape.SQUARE: ("side",),
    TargetShape.RECTANGLE: ("width", "depth"),
    TargetShape.REGULAR_POLYGON: ("sides", "side"),
    TargetShape.CIRCLE: ("radius",),
    TargetShape.POLYGON: ("vertices",),
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


class Outline(NamedTuple):
    """What a target's shape follows from, and nothing else of it: what depends on the shape only is kept by this."""

    shape: TargetShape
    sizes: tuple[Any, ...]
    """The parameters that `SIZES` names."""

    @classmethod
    def of(cls, config: TargetConfig) -> Outline:
        """That of a configured target."""
        return cls(config.shape, tuple(getattr(config, name) for name in SIZES[config.shape]))

    def target(self) -> TargetConfig:
        """A target of this outline; what it weighs and how it moves are the defaults, whether they suit it or not."""
        sizes = dict(zip(SIZES[self.shape], self.sizes, strict=True))
        return TargetConfig.model_construct(shape=self.shape, **sizes)


def target_shape(config: TargetConfig) -> Shape:
    """The shape of a configured target about its centre of mass; not to be written to.

    Raises:
        ConfigError: its vertices are no convex polygon.

    """
    outline = Outline.of(config)
    if config.centre_of_mass_x == config.centre_of_mass_y == 0.0:
        return _shape(outline)
    return _moved(outline, -config.centre_of_mass_x, -config.centre_of_mass_y)


def seen_target_shape(config: TargetConfig) -> Shape:
    """The shape of a configured target about its middle, as methods and perception know it; not to be written to.

    Raises:
        ConfigError: its vertices are no convex polygon.

    """
    return _shape(Outline.of(config))


@compiled
def to_middle(target: Record, pose: FloatArray, twist: FloatArray) -> None:
    """Make pose and twist of the centre of mass those of the middle, each shape (3,), world; both are changed.

    Args:
        target: record of `TargetConfig`.
        pose: [m, m, rad].
        twist: [m/s, m/s, rad/s].

    """
    _move(-target.centre_of_mass_x, -target.centre_of_mass_y, pose, twist)


@compiled
def to_centre_of_mass(target: Record, pose: FloatArray, twist: FloatArray) -> None:
    """Make pose and twist of the middle those of the centre of mass, as `to_middle` does the other way."""
    _move(target.centre_of_mass_x, target.centre_of_mass_y, pose, twist)


@compiled
def _move(along: float, across: float, pose: FloatArray, twist: FloatArray) -> None:
    """From one point of a body to that so far from it in the body's axes [m]."""
    if along == 0.0 and across == 0.0:
        return
    x, y = rotated(pose[2], along, across)
    pose[0] += x
    pose[1] += y
    twist[0] -= twist[2] * y
    twist[1] += twist[2] * x


@lru_cache(maxsize=256)
def _moved(outline: Outline, x: float, y: float) -> Shape:
    return moved(_shape(outline), x, y)


@lru_cache(maxsize=256)
def _shape(outline: Outline) -> Shape:
    sizes = outline.sizes
    match outline.shape:
        case TargetShape.SQUARE:
            return rectangle(sizes[0], sizes[0])
        case TargetShape.RECTANGLE:
            return rectangle(*sizes)
        case TargetShape.REGULAR_POLYGON:
            return regular_polygon(*sizes)
        case TargetShape.CIRCLE:
            return circle(*sizes)
        case TargetShape.POLYGON:
            return even_plate(np.array(sizes[0]))

"""The target: its shape, mass and inertia."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from sim.config import TargetConfig, TargetShape
from sim.model.shape import Shape, circle, even_plate, rectangle, regular_polygon

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
    """The shape of a configured target; not to be written to.

    Raises:
        ConfigError: its vertices are no convex polygon.

    """
    return _shape(Outline.of(config))


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

"""What moment of inertia a body of some outline, mass and centre of mass can have at most.

Wherever its mass is, a body within a rectangle has the largest moment of inertia with all of it in the corners, shared
between both ends so that the centre of mass is where it is said to be. A target has it with all mass on its corner
circle, as a square in that circle has.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.config import MissionConfig
from sim.model.shape import plate_inertia
from sim.model.target import SIZES, target_shape


class Outline(NamedTuple):
    """A rectangle that bounds a body, along the axis on which its centre of mass lies, and what the body weighs."""

    what: str
    group: str
    """Path of the parameters that hold its mass and its moment of inertia."""
    place: str
    """Path of the parameter that places its centre of mass; empty if that is in the middle."""
    shape: tuple[str, ...]
    """Paths of the parameters that give it."""
    behind: float
    """From the centre of mass to the rectangle's end behind it [m]."""
    ahead: float
    """To the other end [m]."""
    half_width: float
    """Across [m]."""
    mass: float
    """[kg]"""
    inertia: float
    """About the centre of mass [kg m2]."""
    even_plate: float
    """Of an even plate of the body's shape and mass, about its middle [kg m2]."""

    @property
    def parameters(self) -> tuple[str, ...]:
        """Paths of all that it follows from."""
        place = (self.place,) if self.place else ()
        return (*self.shape, *place, f"{self.group}.mass", f"{self.group}.inertia")

    @property
    def most(self) -> float:
        """The largest moment of inertia that such a body can have [kg m2]; negative if its centre of mass is outside.

        E[y^2] about the mean is at most behind * ahead, with mass at both ends only; E[x^2] at most half_width^2.
        """
        if min(self.behind, self.ahead) < 0.0:
            return -1.0
        return self.mass * (self.behind * self.ahead + self.half_width**2)


def outlines(config: MissionConfig) -> tuple[Outline, ...]:
    """Every body whose mass and moment of inertia are parameters."""
    return (_target(config), _base(config), *(_link(config, number) for number in (1, 2, 3)), _hand(config))


def _rectangle(
    what: str,
    group: str,
    place: str,
    shape: tuple[str, ...],
    behind: float,
    ahead: float,
    half_width: float,
    mass: float,
    inertia: float,
) -> Outline:
    """The outline of a body that fills the rectangle."""
    even_plate = mass * ((behind + ahead) ** 2 + (2.0 * half_width) ** 2) / 12.0
    return Outline(what, group, place, shape, behind, ahead, half_width, mass, inertia, even_plate)


def _target(config: MissionConfig) -> Outline:
    target, shape = config.target, target_shape(config.target)
    half = shape.corner_circle / math.sqrt(2.0)
    size = ("target.shape", *(f"target.{name}" for name in SIZES[target.shape]))
    plate = plate_inertia(shape, target.mass)
    return Outline("target", "target", "", size, half, half, half, target.mass, target.inertia, plate)


def _base(config: MissionConfig) -> Outline:
    base, group = config.robot.base, "robot.base"
    half, centre = base.depth / 2.0, base.centre_of_mass_ahead
    shape = (f"{group}.width", f"{group}.depth")
    place = f"{group}.centre_of_mass_ahead"
    return _rectangle(
        "base", group, place, shape, half + centre, half - centre, base.width / 2.0, base.mass, base.inertia
    )


def _link(config: MissionConfig, number: int) -> Outline:
    group, radius = f"robot.arm.link_{number}", config.robot.arm.link_radius
    link = (config.robot.arm.link_1, config.robot.arm.link_2, config.robot.arm.link_3)[number - 1]
    behind, ahead = link.centre_of_mass + radius, link.length + radius - link.centre_of_mass
    shape = (f"{group}.length", "robot.arm.link_radius")
    return _rectangle("link", group, f"{group}.centre_of_mass", shape, behind, ahead, radius, link.mass, link.inertia)


def _hand(config: MissionConfig) -> Outline:
    hand, group = config.robot.arm.hand, "robot.arm.hand"
    thickest = max(hand.tip_radius, hand.finger_radius)
    behind = hand.centre_of_mass + hand.finger_radius
    ahead = hand.centre_offset + thickest - hand.centre_of_mass
    shape = tuple(f"{group}.{name}" for name in ("centre_offset", "tip_offset", "tip_radius", "finger_radius"))
    place = f"{group}.centre_of_mass"
    return _rectangle("hand", group, place, shape, behind, ahead, hand.tip_offset + thickest, hand.mass, hand.inertia)

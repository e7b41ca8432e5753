"""How long a physics step may be for contacts to stay stable in the reduced plant."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sim.config import HandMount, MissionConfig, RobotConfig
from sim.model.target import target_shape

CONTACTS: Mapping[str, tuple[str, str]] = {
    "tip": ("stiffness", "damping"),
    "solid": ("solid_stiffness", "solid_damping"),
}
"""Stiffness and damping of each kind of contact."""


def longest_step(config: MissionConfig, kind: str) -> float:
    """The longest step [s] at which the reduced plant's contact with the lightest body is stable.

    Velocity Verlet with damping at the predicted velocity is stable while k h^2 / 4 + c h < m, m the effective mass
    of the contact. No joint makes a body lighter than it is by itself, so m is taken of bodies without joints.
    """
    stiffness, damping = (float(getattr(config.contact, name)) for name in CONTACTS[kind])
    bodies = _hand_bodies(config.robot) if kind == "tip" else _solid_bodies(config.robot)
    target, reach = config.target, target_shape(config.target).corner_circle
    of_target = 1.0 / target.mass + reach**2 / target.inertia
    lightest = max(1.0 / mass + arm**2 / inertia for mass, inertia, arm in bodies) + of_target
    return 2.0 * (math.sqrt(damping**2 + stiffness / lightest) - damping) / stiffness


def _hand_bodies(robot: RobotConfig) -> list[tuple[float, float, float]]:
    """Mass, inertia, and the farthest contact from the centre of mass, of the body that carries the tips."""
    hand, link = robot.arm.hand, robot.arm.link_3
    if robot.servo.hand_mount is HandMount.YIELDING:
        ahead = max(hand.centre_of_mass, hand.centre_offset - hand.centre_of_mass)
        return [(hand.mass, hand.inertia, math.hypot(hand.tip_offset, ahead))]
    mass, hand_centre = hand.mass + link.mass, link.length + hand.centre_of_mass
    centre = (link.mass * link.centre_of_mass + hand.mass * hand_centre) / mass
    inertia = link.inertia + hand.inertia + link.mass * hand.mass / mass * (hand_centre - link.centre_of_mass) ** 2
    reach = max(centre, math.hypot(hand.tip_offset, link.length + hand.centre_offset - centre))
    return [(mass, inertia, reach)]


def _solid_bodies(robot: RobotConfig) -> list[tuple[float, float, float]]:
    """The same of every body that is solid."""
    arm, base = robot.arm, robot.base
    links = [arm.link_1, arm.link_2]
    if robot.servo.hand_mount is HandMount.YIELDING:
        links.append(arm.link_3)
    corner = math.hypot(base.width / 2, base.depth / 2 + abs(base.centre_of_mass_ahead))
    return [
        (base.mass, base.inertia, corner),
        *((it.mass, it.inertia, max(it.centre_of_mass, it.length - it.centre_of_mass)) for it in links),
        *_hand_bodies(robot),
    ]

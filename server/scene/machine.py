"""What robot and target look like: parts with materials, each in the frame of the body that carries them.

Every body lies about the plane z = 0 of its own frame; `WORK_HEIGHT` is where that plane is above the
table. Outlines that touch are those of the configuration; the rest (pads, tanks, nozzles) is dress.
"""

from __future__ import annotations

import math

from server.scene.glb import Part
from server.scene.palette import (
    ALUMINIUM,
    FINGER,
    GRAPHITE,
    LAMP,
    SHELL,
    STEEL,
    TANK,
    TIP,
    TOUCH,
    Colour,
    Material,
    accent,
    light,
    veil,
)
from server.scene.solids import TO_X, TO_Y, ball, box, circle, drum, nozzle, prism, rod, stadium, turn
from sim.config import ArmConfig, BaseConfig, HandConfig, LinkConfig, RobotConfig

PAD_HEIGHT = 0.010
"""Thickness of an air bearing [m]."""
BODY_UNDERSIDE = 0.022
"""Height of the base's underside above the table [m]."""


def base_parts(robot: RobotConfig, height: float) -> list[Part]:
    """The base about its geometric centre, its front (shoulders) towards +y."""
    base = robot.base
    floor, low, high = -height, BODY_UNDERSIDE - height, 0.042
    return [
        *_body(base, low, high),
        *_deck(base, high),
        *_thrusters(base, (low + high) / 2),
        *_air_bearings(base, floor, low),
        *_shoulders(base, robot.arm.link_radius),
    ]


def _body(base: BaseConfig, low: float, high: float) -> list[Part]:
    """Shell with a dark belt, panel seams, and a lamp towards the target."""
    corner = 0.12 * min(base.width, base.depth)
    width, depth = base.width, base.depth
    seams = [
        (box(0.0016, depth + 0.0012, low + 0.012, high - 0.008, 0.0006).moved(x), GRAPHITE)
        for x in (-0.17 * width, 0.17 * width)
    ]
    belt = box(width + 0.003, depth + 0.003, low + 0.020, low + 0.040, corner + 0.0015, bevel=0.002)
    lamp = box(0.30 * width, 0.004, 0.020, 0.026, 0.0015, bevel=0.001).moved(0.0, depth / 2)
    return [(box(width, depth, low, high, corner, bevel=0.007), SHELL), (belt, GRAPHITE), (lamp, LAMP), *seams]


def _deck(base: BaseConfig, high: float) -> list[Part]:
    """On top: a dark plate with two air tanks, the computer and an antenna."""
    width, depth = base.width, base.depth
    radius = 0.135 * depth
    plate = box(0.88 * width, 0.80 * depth, high - 0.001, high + 0.003, 0.012, bevel=0.0015)
    parts: list[Part] = [(plate, GRAPHITE)]
    tank = prism(circle(radius), -0.31 * width, 0.31 * width, radius, steps=6).turned(TO_X)
    for y in (-0.24 * depth, 0.05 * depth):
        centre = high + 0.003 + 0.92 * radius
        parts.append((tank.moved(0.0, y, centre), TANK))
        strap = prism(circle(radius + 0.0012), -0.004, 0.004).turned(TO_X)
        parts += [(strap.moved(x, y, centre), STEEL) for x in (-0.16 * width, 0.16 * width)]
    computer = box(0.46 * width, 0.13 * depth, high, high + 0.018, 0.004, bevel=0.002).moved(0.0, 0.31 * depth)
    lights = [(ball(0.0028).moved(x * width, 0.31 * depth, high + 0.0185), LAMP) for x in (-0.05, 0.0, 0.05)]
    return [*parts, (computer, ALUMINIUM), *lights]


def _thrusters(base: BaseConfig, middle: float) -> list[Part]:
    """Two cold-gas nozzles at each rear corner and one at each flank."""
    jet = nozzle(0.004, 0.010, 0.016)
    parts: list[Part] = []
    for side in (-1.0, 1.0):
        outward = jet.turned(TO_X).turned(turn(0.0 if side > 0 else math.pi))
        parts += [(outward.moved(side * base.width / 2, y * base.depth, middle), STEEL) for y in (-0.28, 0.0)]
        backward = jet.turned(TO_Y).turned(turn(math.pi))
        parts.append((backward.moved(side * 0.36 * base.width, -base.depth / 2, middle), STEEL))
    return parts


def _air_bearings(base: BaseConfig, floor: float, low: float) -> list[Part]:
    """Three round pads that the base floats on."""
    parts: list[Part] = []
    for x, y in ((-0.34, -0.20), (0.34, -0.20), (0.0, 0.24)):
        place = (x * base.width, y * base.depth)
        pad = drum(0.22 * base.depth, floor + 0.001, floor + PAD_HEIGHT, 0.002).moved(*place)
        leg = drum(0.05 * base.depth, floor + PAD_HEIGHT, low + 0.004).moved(*place)
        parts += [(pad, STEEL), (leg, GRAPHITE)]
    return parts


def _shoulders(base: BaseConfig, link_radius: float) -> list[Part]:
    """Brackets from the front corners to the shoulder joints, above and below the first links."""
    parts: list[Part] = []
    for side in (-1.0, 1.0):
        corner = (side * base.width / 2, base.depth / 2)
        bracket = stadium(0.055, 1.30 * link_radius, 1.1 * link_radius)
        for low, high in ((-0.034, -0.024), (0.024, 0.034)):
            arm = prism(bracket, low, high, 0.002).turned(turn(math.pi - side * 0.6))
            parts.append((arm.moved(*corner), GRAPHITE))
        parts.append((drum(0.75 * link_radius, -0.030, 0.040, 0.002).moved(*corner), STEEL))
    return parts


def link_parts(link: LinkConfig, arm: ArmConfig, colour: Colour, height: float) -> list[Part]:
    """Link 1 or 2 from its proximal joint along +y, with the drum and air bearing of its distal joint."""
    radius = arm.link_radius
    beam = prism(stadium(link.length, 1.05 * radius, 0.95 * radius), -0.012, 0.012, 0.004)
    groove = prism(stadium(0.56 * link.length, 0.42 * radius, 0.42 * radius), 0.0115, 0.0128)
    elbow = drum(1.18 * radius, -0.020, 0.020, 0.003).moved(y=link.length)
    cap = drum(0.62 * radius, 0.019, 0.023, 0.0015).moved(y=link.length)
    leg = drum(0.004, PAD_HEIGHT - height, -0.018).moved(y=link.length)
    pad = drum(0.020, 0.001 - height, PAD_HEIGHT - height, 0.002).moved(y=link.length)
    return [
        (beam, ALUMINIUM),
        (groove.moved(y=0.22 * link.length), GRAPHITE),
        *_joint(radius, colour),
        (elbow, GRAPHITE),
        (cap, STEEL),
        (leg, STEEL),
        (pad, STEEL),
    ]


def _joint(radius: float, colour: Colour) -> list[Part]:
    """The drum at a link's own joint, with a band in the arm's colour."""
    return [
        (drum(1.22 * radius, -0.016, 0.016, 0.003), GRAPHITE),
        (drum(1.26 * radius, -0.0035, 0.0035, 0.001), accent(colour)),
        (drum(0.80 * radius, 0.015, 0.0215, 0.001), accent(colour)),
        (drum(0.60 * radius, 0.020, 0.0225, 0.001), GRAPHITE),
    ]


def wrist_parts(arm: ArmConfig, colour: Colour) -> list[Part]:
    """Link 3 from its joint along +y, with the force sensor before the hand."""
    radius, length = 0.78 * arm.link_radius, arm.link_3.length
    beam = prism(stadium(length, radius, 0.8 * radius), -0.010, 0.010, 0.004)
    sensor = drum(1.15 * radius, -0.013, 0.013, 0.002).moved(y=0.72 * length)
    band = drum(1.19 * radius, -0.003, 0.003, 0.001).moved(y=0.72 * length)
    return [(beam, ALUMINIUM), *_joint(arm.link_radius, colour), (sensor, GRAPHITE), (band, accent(colour))]


def hand_parts(hand: HandConfig) -> list[Part]:
    """The U-shaped hand about its mount at the end of link 3, its tips towards +y."""
    return u_parts(hand, 0.0, FINGER, TIP)


def u_parts(hand: HandConfig, base: float, body: Material, tip: Material) -> list[Part]:
    """Palm, fingers and tips of a hand whose palm lies at y = `base`."""
    half, reach = hand.tip_offset, base + hand.centre_offset
    solids = [rod((-half, base), (half, base), hand.finger_radius)]
    solids += [rod((x, base), (x, reach), hand.finger_radius) for x in (-half, half)]
    tips = [ball(hand.tip_radius).moved(x, reach) for x in (-half, half)]
    return [*((solid, body) for solid in solids), *((solid, tip) for solid in tips)]


def tip_glow_parts(radius: float) -> list[Part]:
    """What covers a tip while it touches: a bright ball and a halo."""
    return [(ball(1.04 * radius), light(TOUCH)), (ball(1.7 * radius), veil(TOUCH, 0.22))]


def goal_hand_parts(hand: HandConfig, colour: Colour) -> list[Part]:
    """A see-through hand about its centre, where a plan ends."""
    return u_parts(hand, -hand.centre_offset, veil(colour, 0.34), veil(colour, 0.5))

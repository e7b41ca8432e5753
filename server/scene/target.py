"""What the target looks like: a small satellite of whatever outline, about its centre of mass.

Its outline is the one that is touched; panels, cells, mark and bearing are dress, scaled by the largest circle within.
"""

from __future__ import annotations

import math

from server.scene.glb import Part
from server.scene.machine import PAD_HEIGHT
from server.scene.palette import FACES, FOIL, GRAPHITE, MARK, SHELL, SOLAR, STEEL, Colour, veil
from server.scene.solids import TO_Y, Solid, box, circle, drum, nozzle, outline_of, prism, stadium, turn
from sim.model.shape import Shape, inner_radius, signed_distance

TARGET_CLEARANCE = 0.020
"""Height of the target's underside above the table [m]: room for its air bearing."""
TARGET_FLATNESS = 0.7
"""Height of the target over its width: the plane says nothing of it, and a low one hides less."""
_EDGE = 0.004
"""Radius that corners are drawn with [m]."""
_SKIN = 0.0015
"""How far panels stand out of the body [m]."""


def half_height(shape: Shape) -> float:
    """From the target's middle to its roof [m]."""
    return TARGET_FLATNESS * inner_radius(shape)


def work_height(shape: Shape) -> float:
    """Height of arms, tips and the target's middle above the table [m]."""
    return TARGET_CLEARANCE + half_height(shape)


def target_parts(shape: Shape) -> list[Part]:
    """The target about its centre of mass."""
    roof, width = half_height(shape), 2.0 * inner_radius(shape)
    floor = -roof - TARGET_CLEARANCE
    outline = outline_of(shape, min(_EDGE + _SKIN, 0.1 * width)).inset(_SKIN if shape.sides else 0.0)
    return [
        (prism(outline, -roof, roof, 0.003), GRAPHITE),
        *_side_panels(shape),
        *_roof(shape),
        *_front_mark(shape),
        (drum(0.30 * width, floor + 0.001, floor + PAD_HEIGHT, 0.002), STEEL),
        (drum(0.10 * width, floor + PAD_HEIGHT, 0.002 - roof), GRAPHITE),
    ]


def _side_panels(shape: Shape) -> list[Part]:
    """A panel on each side and a strip along its upper edge, distinguished by colour."""
    roof, width = half_height(shape), 2.0 * inner_radius(shape)
    parts: list[Part] = []
    for side in range(shape.sides):
        out, middle, length = _side(shape, side)
        material, rotation = FACES[side % len(FACES)], turn(math.atan2(shape.normals[side, 1], shape.normals[side, 0]))
        panel = box(0.004, 0.93 * length, -0.88 * roof, 0.88 * roof, 0.0012, bevel=0.001).moved(out - 0.002, middle)
        strip = box(0.075 * width, 0.80 * length, roof - 0.001, roof + 0.0012, 0.002, bevel=0.0008)
        strip = strip.moved(out - 0.0475 * width, middle)
        parts += [(panel.turned(rotation), material), (strip.turned(rotation), material)]
        seam = box(0.0010, 0.93 * length, 0.0, 0.0014, 0.0004).moved(out - 0.0004, middle)
        parts += [(seam.moved(z=z).turned(rotation), GRAPHITE) for z in (-roof / 3, roof / 3)]
    return parts


def _side(shape: Shape, side: int) -> tuple[float, float, float]:
    """Of a side: distance of its line, and along it its middle and its length [m]."""
    nx, ny = shape.normals[side]
    ends = [nx * y - ny * x for x, y in (shape.vertices[side], shape.vertices[(side + 1) % shape.corners])]
    return float(shape.offsets[side]) + shape.rounding, 0.5 * float(sum(ends)), float(ends[1] - ends[0])


def _roof(shape: Shape) -> list[Part]:
    """Solar cells, as many as have room, around a foil hub with an antenna."""
    roof, width = half_height(shape), 2.0 * inner_radius(shape)
    pitch = 0.19 * width
    cells: list[Part] = []
    for column in range(4):
        for row in range(4):
            x, y = (column - 1.5) * pitch, (row - 1.5) * pitch
            if signed_distance(shape, x, y) > -0.75 * pitch:
                continue
            cell = box(0.92 * pitch, 0.92 * pitch, roof - 0.001, roof + 0.0016, 0.0015, bevel=0.0005)
            cells.append((cell.moved(x, y), SOLAR))
    hub = drum(0.115 * width, roof, roof + 0.006, 0.002)
    dish = nozzle(0.02 * width, 0.075 * width, 0.10 * width).moved(z=roof + 0.005)
    return [*cells, (hub, FOIL), (dish, SHELL)]


def _front_mark(shape: Shape) -> list[Part]:
    """The mark to read the angle by: an arrow head towards +y, and a docking ring if a side faces there."""
    roof, width = half_height(shape), 2.0 * inner_radius(shape)
    parts: list[Part] = [(_pointer(shape, roof, roof + 0.0034), MARK)]
    for side in range(shape.sides):
        if shape.normals[side, 1] > 0.999:
            out, _, _ = _side(shape, side)
            ring = prism(circle(0.16 * width), out - 0.001, out + 0.0006).turned(TO_Y)
            eye = prism(circle(0.11 * width), out - 0.001, out + 0.0010).turned(TO_Y)
            parts += [(ring, MARK), (eye, GRAPHITE)]
    return parts


def _pointer(shape: Shape, low: float, high: float) -> Solid:
    """The arrow head."""
    width = 2.0 * inner_radius(shape)
    return prism(stadium(0.05 * width, 0.045 * width, 0.004 * width), low, high).moved(y=0.33 * width)


def ghost_parts(shape: Shape, colour: Colour) -> list[Part]:
    """A see-through target about its centre of mass, where it is predicted to be."""
    roof = half_height(shape)
    body = prism(outline_of(shape, min(_EDGE, 0.1 * inner_radius(shape))), -roof, roof, 0.003)
    return [(body, veil(colour, 0.10)), (_pointer(shape, roof, roof + 0.002), veil(colour, 0.7))]

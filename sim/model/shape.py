"""Shapes in the plane: convex polygons with a rounding radius, about an origin within them.

A shape is every point within its rounding of a polygon; a circle is the one with no sides, a single corner and its
radius. Contact, clearance, caging, plants and drawings ask a shape for distances and normals; none of them knows
which one it is. Points are given in the shape's frame; where a body moves, its origin is the centre of mass.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.errors import ConfigError
from sim.parameters import points_text

MOST_CORNERS = 12
"""Of a polygon: a shape's arrays have room for as many, so that compiled code is the same for all shapes."""

_SAME = 1e-9
"""Two lengths of a shape count as the same within this part of its size, and two directions within this angle [rad]."""


class Shape(NamedTuple):
    """A convex polygon and how far beyond it the shape reaches; in its own frame, SI."""

    corners: int
    """Of the polygon; 1 for a circle."""
    sides: int
    """As many as corners; 0 for a circle."""
    vertices: FloatArray
    """Its corners, counter-clockwise, shape (MOST_CORNERS, 2) [m]; what is beyond them counts for nothing."""
    normals: FloatArray
    """Outward unit normal of the side from each corner to the next, shape (MOST_CORNERS, 2); likewise."""
    offsets: FloatArray
    """Distance of each side's line from the origin along its normal, shape (MOST_CORNERS,) [m]; likewise."""
    rounding: float
    """How far the shape reaches beyond its polygon [m]."""
    corner_circle: float
    """Radius of the smallest circle about the origin that holds the shape [m]."""
    symmetry_angle: float
    """Smallest turn that makes it the same shape again [rad]; 0 if every turn does."""
    is_square: bool
    """Four equal sharp corners about the centre: the one shape that the authors' law of the face is for."""


def polygon(vertices: FloatArray, rounding: float = 0.0) -> Shape:
    """A convex polygon about its centre of mass.

    Args:
        vertices: counter-clockwise from the centre of mass, shape (corners, 2) [m]; a single one with a rounding
            makes a circle.
        rounding: how far the shape reaches beyond the polygon [m].

    Raises:
        ConfigError: two corners or too many, one that is not convex, or a circle without a radius.

    """
    corners = np.asarray(vertices, dtype=np.float64)
    count = len(corners)
    if count > MOST_CORNERS:
        raise ConfigError(f"vertices = {count} corners: a shape has at most {MOST_CORNERS}")
    if rounding < 0.0 or (count == 1 and rounding == 0.0):
        raise ConfigError(f"rounding = {rounding:g} m: it must be above zero for a circle, and never below")
    radii = np.hypot(corners[:, 0], corners[:, 1])
    size = float(radii.max())
    if count == 1:
        normals, offsets = np.empty((0, 2)), np.empty(0)
    else:
        _require_convex(corners)
        normals = _outward_normals(corners)
        offsets = normals[:, 0] * corners[:, 0] + normals[:, 1] * corners[:, 1]
    symmetry = _symmetry_angle(corners, size)
    return Shape(
        corners=count,
        sides=len(normals),
        vertices=_with_room(corners),
        normals=_with_room(normals),
        offsets=_with_room(offsets),
        rounding=float(rounding),
        corner_circle=size + rounding,
        symmetry_angle=symmetry,
        is_square=count == 4 and rounding == 0.0 and symmetry == 0.5 * math.pi,
    )


def rectangle(width: float, depth: float, ahead: float = 0.0) -> Shape:
    """A rectangle whose sides are those long [m], along x and y; its centre of mass is so far ahead (+y) of its middle.

    A square if both are the same and the centre of mass is its middle.
    """
    x, front, back = width / 2, depth / 2 - ahead, -depth / 2 - ahead
    return polygon(np.array([[x, back], [x, front], [-x, front], [-x, back]]))


def regular_polygon(sides: int, side: float) -> Shape:
    """A regular polygon with that many sides of that length [m], one of them facing +x."""
    circumradius = side / (2.0 * math.sin(math.pi / sides))
    angles = (2.0 * np.arange(sides) - 1.0) * math.pi / sides
    return polygon(circumradius * np.column_stack((np.cos(angles), np.sin(angles))))


def circle(radius: float) -> Shape:
    """A circle of that radius [m]."""
    return polygon(np.zeros((1, 2)), radius)


def even_plate(vertices: FloatArray) -> Shape:
    """A convex polygon whose corners are given from any origin, with its centre of mass at its centroid.

    Raises:
        ConfigError: as for `polygon`.

    """
    _require_convex(vertices)
    return polygon(about_its_centroid(vertices))


def about_its_centroid(vertices: FloatArray) -> FloatArray:
    """The corners of a polygon, shape (corners, 2) [m], moved so that an even plate has its centre of mass at 0."""
    x, y = vertices[:, 0], vertices[:, 1]
    next_x, next_y = np.roll(x, -1), np.roll(y, -1)
    doubled = x * next_y - next_x * y
    centre = np.array([(doubled * (x + next_x)).sum(), (doubled * (y + next_y)).sum()]) / (3.0 * doubled.sum())
    centred: FloatArray = vertices - centre
    return centred


def moved(shape: Shape, x: float, y: float) -> Shape:
    """The shape with all of it moved in its frame [m], whose origin stays.

    Raises:
        ConfigError: as for `polygon`.

    """
    return polygon(shape.vertices[: shape.corners] + np.array([x, y]), shape.rounding)


def inner_radius(shape: Shape) -> float:
    """Radius of the largest circle about the origin within the shape [m]; negative if the origin is outside."""
    return -signed_distance(shape, 0.0, 0.0)


def outline(shape: Shape, points_of_a_turn: int = 48) -> FloatArray:
    """Points along the outline, counter-clockwise, shape (points, 2) [m]: its corners, or arcs where it is rounded."""
    corners, normals = shape.vertices[: shape.corners], shape.normals[: shape.sides]
    if shape.rounding == 0.0:
        return corners
    if shape.sides == 0:
        return _arc(corners[0], shape.rounding, np.linspace(0.0, 2.0 * math.pi, points_of_a_turn, endpoint=False))
    arcs: list[FloatArray] = []
    for corner, after in zip(corners, normals, strict=True):
        before = normals[len(arcs) - 1]
        sweep = math.atan2(before[0] * after[1] - before[1] * after[0], before @ after)
        count = max(2, math.ceil(points_of_a_turn * sweep / (2.0 * math.pi)))
        angles = math.atan2(before[1], before[0]) + np.linspace(0.0, sweep, count)
        arcs.append(_arc(corner, shape.rounding, angles))
    return np.concatenate(arcs)


def _arc(centre: FloatArray, radius: float, angles: FloatArray) -> FloatArray:
    """Points at those angles [rad] of a circle, shape (angles, 2) [m]."""
    points: FloatArray = centre + radius * np.column_stack((np.cos(angles), np.sin(angles)))
    return points


def area(shape: Shape) -> float:
    """Of the shape, rounding and all [m2]."""
    return _moments(shape)[0]


def plate_inertia(shape: Shape, mass: float) -> float:
    """Moment of inertia about the origin [kg m2] of an even plate of that shape and mass [kg]."""
    plate, second = _moments(shape)
    return mass * second / plate


def _moments(shape: Shape) -> tuple[float, float]:
    """Area [m2] and polar second moment about the origin [m4]: polygon, bands along its sides, sectors at corners."""
    r = shape.rounding
    if shape.sides == 0:
        x, y = shape.vertices[0]
        plate = math.pi * r**2
        return plate, plate * (float(x**2 + y**2) + 0.5 * r**2)
    plate = second = 0.0
    for place, (x, y) in enumerate(shape.vertices[: shape.corners]):
        after = (place + 1) % shape.corners
        next_x, next_y = shape.vertices[after]
        (nx, ny), (next_nx, next_ny) = shape.normals[place], shape.normals[after]
        doubled = x * next_y - next_x * y
        plate += 0.5 * doubled
        second += doubled * (x * x + x * next_x + next_x**2 + y * y + y * next_y + next_y**2) / 12.0
        begin, end, offset = nx * y - ny * x, nx * next_y - ny * next_x, shape.offsets[place]
        plate += r * (end - begin)
        second += (end - begin) * ((offset + r) ** 3 - offset**3) / 3.0 + r * (end**3 - begin**3) / 3.0
        turn = math.atan2(nx * next_ny - ny * next_nx, nx * next_nx + ny * next_ny)
        plate += 0.5 * turn * r**2
        outwards = next_x * (next_ny - ny) - next_y * (next_nx - nx)
        second += 0.5 * turn * r**2 * (next_x**2 + next_y**2) + 2.0 * r**3 / 3.0 * outwards + 0.25 * turn * r**4
    return float(plate), float(second)


def _with_room(values: FloatArray) -> FloatArray:
    """The values of each corner or side, and zeros after them."""
    result = np.zeros((MOST_CORNERS, *values.shape[1:]))
    result[: len(values)] = values
    return result


def _outward_normals(corners: FloatArray) -> FloatArray:
    """Of a convex polygon's sides, shape (sides, 2)."""
    along = np.roll(corners, -1, axis=0) - corners
    normals: FloatArray = np.column_stack((along[:, 1], -along[:, 0])) / np.hypot(along[:, 0], along[:, 1])[:, None]
    return normals


def _require_convex(corners: FloatArray) -> None:
    """Refuse corners, shape (corners, 2), that are not those of a convex polygon in counter-clockwise order.

    Raises:
        ConfigError: the message names the corner, counted from 1, and what is wrong with it.

    """
    fault = _fault(corners)
    if fault is not None:
        raise ConfigError(
            f"vertices = '{points_text(tuple(map(tuple, corners.tolist())))}': they are no convex polygon: {fault}",
            tip="give at least three corners, counter-clockwise, each of which turns left",
        )


def _fault(corners: FloatArray) -> str | None:
    """What keeps corners, shape (corners, 2), from being those of a convex polygon; None if nothing does."""
    if len(corners) < 3:
        return f"there are {len(corners)}"
    along = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(along[:, 0], along[:, 1])
    shortest = int(lengths.argmin())
    if lengths[shortest] <= _SAME * float(np.ptp(corners, axis=0).max()):
        return f"vertices {shortest + 1} and {(shortest + 1) % len(corners) + 1} are the same point"
    before = np.roll(along, 1, axis=0)
    turns = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
    if turns.max() < -_SAME:
        return "they go around clockwise; write them the other way round"
    place = int(turns.argmin())
    where = f"vertex {place + 1} ({corners[place, 0]:g}, {corners[place, 1]:g})"
    if turns[place] < -_SAME:
        return f"at {where} the outline turns right"
    if turns[place] <= _SAME:
        return f"{where} lies on the line between its neighbours; leave it out"
    return "the outline goes around more than once" if turns.sum() > 3.0 * math.pi else None


def _symmetry_angle(corners: FloatArray, size: float) -> float:
    """The smallest turn [rad] that puts every corner onto one; 0 for a single corner at the centre."""
    count = len(corners)
    if count == 1:
        return 0.0 if size == 0.0 else 2.0 * math.pi
    for shift in range(1, count + 1):
        angle = 2.0 * math.pi * shift / count
        c, s = math.cos(angle), math.sin(angle)
        turned = corners @ np.array([[c, s], [-s, c]])
        if count % shift == 0 and np.abs(turned - np.roll(corners, -shift, axis=0)).max() <= _SAME * size:
            return angle
    raise AssertionError("a whole turn changes nothing")


@compiled
def facing_side(shape: Shape, x: float, y: float) -> tuple[float, float, float]:
    """The side whose line a point is farthest outside of: its signed distance [m], and the side's normal.

    Beside the polygon that is the distance from its nearest side, beyond a corner from a side that went on. The
    shape must have sides.
    """
    side, distance = _facing_side(shape, x, y)
    return distance - shape.rounding, shape.normals[side, 0], shape.normals[side, 1]


@compiled
def signed_distance(shape: Shape, x: float, y: float) -> float:
    """Distance of a point from the shape's outline [m], negative inside."""
    return surface(shape, x, y)[0]


@compiled
def surface(shape: Shape, x: float, y: float) -> tuple[float, float, float]:
    """Signed distance of a point from the outline [m], and the outward unit normal at the outline's nearest point.

    The point and the normal are in the shape's frame. The farthest side line's side always has the polygon's nearest
    point: of all normals, that of a side at the nearest corner is closest to the direction that the point lies in.
    """
    if shape.sides == 0:
        return _from_corner(shape, 0, x, y)
    side, distance = _facing_side(shape, x, y)
    nx, ny = shape.normals[side, 0], shape.normals[side, 1]
    if distance > 0.0:
        after = side + 1 if side + 1 < shape.corners else 0
        if nx * (y - shape.vertices[side, 1]) - ny * (x - shape.vertices[side, 0]) < 0.0:
            return _from_corner(shape, side, x, y)
        if nx * (y - shape.vertices[after, 1]) - ny * (x - shape.vertices[after, 0]) > 0.0:
            return _from_corner(shape, after, x, y)
    return distance - shape.rounding, nx, ny


@compiled_inline
def _facing_side(shape: Shape, x: float, y: float) -> tuple[int, float]:
    """The side whose line the point is farthest outside of, and how far [m]; the first of equals."""
    side, largest = 0, -math.inf
    for place in range(shape.sides):
        distance = shape.normals[place, 0] * x + shape.normals[place, 1] * y - shape.offsets[place]
        if distance > largest:
            side, largest = place, distance
    return side, largest


@compiled
def _from_corner(shape: Shape, corner: int, x: float, y: float) -> tuple[float, float, float]:
    """Signed distance from the rounded corner [m] and the unit vector away from it; along x at the corner itself."""
    dx, dy = x - shape.vertices[corner, 0], y - shape.vertices[corner, 1]
    distance = math.hypot(dx, dy)
    if distance == 0.0:
        return -shape.rounding, 1.0, 0.0
    return distance - shape.rounding, dx / distance, dy / distance

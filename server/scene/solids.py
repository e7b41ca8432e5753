"""Solids of which the machine is built: prisms with rounded edges over rounded outlines.

A sphere is a prism whose bevel is its radius, a rod one over a narrow stadium; so one shape serves all.
Normals are exact, which is what makes highlights run smoothly. Lengths in metres.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sim.model.shape import Shape

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.uint32]

ARC_POINTS = 9
"""Points on a quarter circle of an outline."""


class SolidOutline(NamedTuple):
    """A convex closed curve, counter-clockwise, with its outward normals; both of shape (points, 2)."""

    points: FloatArray
    normals: FloatArray

    def inset(self, distance: float) -> SolidOutline:
        """The outline drawn in by that distance along its normals."""
        return SolidOutline(self.points - distance * self.normals, self.normals)


class Solid(NamedTuple):
    """A triangle mesh: vertices and normals of shape (vertices, 3), faces of shape (triangles, 3)."""

    vertices: FloatArray
    normals: FloatArray
    faces: IndexArray

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid:
        """The solid shifted."""
        return self._replace(vertices=self.vertices + np.array([x, y, z]))

    def turned(self, rotation: FloatArray) -> Solid:
        """The solid rotated about the origin by a matrix of shape (3, 3)."""
        return self._replace(vertices=self.vertices @ rotation.T, normals=self.normals @ rotation.T)


TO_X = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""Rotation that lays a solid's z axis along x."""
TO_Y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Rotation that lays a solid's z axis along y."""


def turn(angle: float) -> FloatArray:
    """Rotation about z, shape (3, 3)."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _arcs(centres: FloatArray, radii: FloatArray, starts: FloatArray, sweeps: FloatArray) -> SolidOutline:
    """The curve through arcs, one after the other; what lies between them is straight."""
    points, normals = [], []
    for centre, radius, start, sweep in zip(centres, radii, starts, sweeps, strict=True):
        angles = start + np.linspace(0.0, sweep, max(3, round(ARC_POINTS * abs(sweep) / (math.pi / 2))))
        normal = np.column_stack((np.cos(angles), np.sin(angles)))
        normals.append(normal)
        points.append(centre + radius * normal)
    return SolidOutline(np.concatenate(points), np.concatenate(normals))


def circle(radius: float) -> SolidOutline:
    """A circle about the origin."""
    angles = np.linspace(0.0, 2 * math.pi, 4 * ARC_POINTS - 4, endpoint=False)
    normals = np.column_stack((np.cos(angles), np.sin(angles)))
    return SolidOutline(radius * normals, normals)


def rectangle(width: float, depth: float, corner: float) -> SolidOutline:
    """A rectangle about the origin with rounded corners."""
    x, y = width / 2 - corner, depth / 2 - corner
    centres = np.array([[x, y], [-x, y], [-x, -y], [x, -y]])
    quarter = math.pi / 2
    return _arcs(centres, np.full(4, corner), quarter * np.arange(4.0), np.full(4, quarter))


def outline_of(shape: Shape, corner: float) -> SolidOutline:
    """The outline of a shape, its corners rounded by that radius from within."""
    if shape.sides == 0:
        return circle(shape.rounding)
    vertices, normals = shape.vertices[: shape.corners], shape.normals[: shape.sides]
    before = np.roll(normals, 1, axis=0)
    cosines = (before * normals).sum(axis=1)
    sines = before[:, 0] * normals[:, 1] - before[:, 1] * normals[:, 0]
    centres = vertices - corner * (before + normals) / (1.0 + cosines)[:, None]
    starts = np.arctan2(before[:, 1], before[:, 0])
    return _arcs(centres, np.full(shape.corners, corner + shape.rounding), starts, np.arctan2(sines, cosines))


def stadium(length: float, first: float, second: float) -> SolidOutline:
    """The hull of a circle of radius `first` at the origin and one of radius `second` at (0, length)."""
    lean = math.asin((first - second) / length)
    centres = np.array([[0.0, length], [0.0, 0.0]])
    starts = np.array([lean, math.pi - lean])
    sweeps = np.array([math.pi - 2 * lean, math.pi + 2 * lean])
    return _arcs(centres, np.array([second, first]), starts, sweeps)


def _profile(low: float, high: float, bevel: float, steps: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Inset, height and normal (outward, up) along the side of a prism, from below to above."""
    angles = np.linspace(0.0, math.pi / 2, steps + 1)
    inset = bevel * (1 - np.cos(angles))
    rise = bevel * np.sin(angles)
    insets = np.concatenate((inset[::-1], inset))
    heights = np.concatenate((low + bevel - rise[::-1], high - bevel + rise))
    tilt = np.concatenate((-angles[::-1], angles))
    return insets, heights, np.column_stack((np.cos(tilt), np.sin(tilt)))


def prism(outline: SolidOutline, low: float, high: float, bevel: float = 0.0, steps: int = 3) -> Solid:
    """The outline from one height to the other, its rims rounded by `bevel`."""
    insets, heights, tilts = _profile(low, high, bevel, steps if bevel else 0)
    count = len(outline.points)
    rings, normals = [], []
    for inset, height, (out, up) in zip(insets, heights, tilts, strict=True):
        points = outline.inset(inset).points
        rings.append(np.column_stack((points, np.full(count, height))))
        normals.append(np.column_stack((out * outline.normals, np.full(count, up))))
    side = Solid(np.concatenate(rings), np.concatenate(normals), _band_faces(len(rings), count))
    return joined([side, _cap(rings[0], -1.0), _cap(rings[-1], 1.0)])


def _band_faces(rings: int, count: int) -> IndexArray:
    """Triangles between consecutive rings of as many points."""
    ring, point = np.meshgrid(np.arange(rings - 1), np.arange(count), indexing="ij")
    following = (point + 1) % count
    a, b = ring * count + point, ring * count + following
    c, d = a + count, b + count
    return np.concatenate((np.stack((a, b, d), -1), np.stack((a, d, c), -1))).reshape(-1, 3).astype(np.uint32)


def _cap(ring: FloatArray, up: float) -> Solid:
    """A fan that closes a ring, facing up (1) or down (-1)."""
    count = len(ring)
    vertices = np.vstack((ring, ring.mean(axis=0)))
    first, following = np.arange(count), (np.arange(count) + 1) % count
    rim = (first, following) if up > 0 else (following, first)
    faces = np.column_stack((*rim, np.full(count, count))).astype(np.uint32)
    return Solid(vertices, np.tile([0.0, 0.0, up], (count + 1, 1)), faces)


def joined(solids: list[Solid]) -> Solid:
    """Several solids as one mesh."""
    offsets = np.cumsum([0, *(len(solid.vertices) for solid in solids[:-1])])
    faces = [solid.faces + np.uint32(offset) for solid, offset in zip(solids, offsets, strict=True)]
    return Solid(
        np.concatenate([solid.vertices for solid in solids]),
        np.concatenate([solid.normals for solid in solids]),
        np.concatenate(faces).astype(np.uint32),
    )


def ball(radius: float) -> Solid:
    """A sphere about the origin."""
    return prism(circle(radius), -radius, radius, radius, steps=ARC_POINTS - 2)


def rod(start: tuple[float, float], end: tuple[float, float], radius: float) -> Solid:
    """A round bar in the plane z = 0 with hemispherical ends."""
    (x, y), (to_x, to_y) = start, end
    length = math.hypot(to_x - x, to_y - y)
    solid = prism(stadium(length, radius, radius), -radius, radius, radius, steps=5)
    return solid.turned(turn(math.atan2(to_y - y, to_x - x) - math.pi / 2)).moved(x, y)


def box(width: float, depth: float, low: float, high: float, corner: float, *, bevel: float = 0.0) -> Solid:
    """A block about the z axis with rounded edges."""
    return prism(rectangle(width, depth, corner), low, high, bevel)


def drum(radius: float, low: float, high: float, bevel: float = 0.0) -> Solid:
    """A cylinder about the z axis."""
    return prism(circle(radius), low, high, bevel, steps=2)


def nozzle(throat: float, mouth: float, length: float) -> Solid:
    """An open cone along z, seen from both sides."""
    ring, wide = circle(throat), circle(mouth)
    slope = np.array([length, throat - mouth]) / math.hypot(length, mouth - throat)
    normals = np.column_stack((slope[0] * ring.normals, np.full(len(ring.normals), slope[1])))
    low = np.column_stack((ring.points, np.zeros(len(ring.points))))
    high = np.column_stack((wide.points, np.full(len(wide.points), length)))
    faces = _band_faces(2, len(low))
    outside = Solid(np.vstack((low, high)), np.vstack((normals, normals)), faces)
    return joined([outside, Solid(outside.vertices, -outside.normals, faces[:, ::-1])])

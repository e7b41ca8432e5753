"""Where the scene is looked at from: camera presets, framed for the window that shows them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from viser.transforms import SO3

from server.scene.solids import FloatArray
from sim.config import MissionConfig
from sim.model.target import target_shape

CameraName = Literal["perspective", "top", "follow", "hand"]
CAMERAS: tuple[CameraName, ...] = ("perspective", "top", "follow", "hand")

FIELD_OF_VIEW = math.radians(26)
"""Vertical [rad]: long enough a lens that the plane keeps its shape."""
ELEVATION, AZIMUTH = math.radians(50), math.radians(-14)
"""Of the default view: above the table, and to the left of straight behind the robot."""
FILL = 0.86
"""Share of the window that the machine may take."""
WIDE = 900 / 420
"""The window assumed before a browser has reported its own: width over height."""


class View(NamedTuple):
    """A camera's place and what it looks at, in world axes, z up, each of shape (3,) [m]."""

    position: FloatArray
    look_at: FloatArray


class Extent(NamedTuple):
    """The stretch of table that robot and target take at the start [m]."""

    half_width: float
    rear: float
    front: float

    @property
    def middle(self) -> float:
        """Its middle along y."""
        return (self.rear + self.front) / 2


def extent(config: MissionConfig) -> Extent:
    """What the default view frames: base, reach of the first links to the sides, and target."""
    base = config.robot.base
    half_width = base.width / 2 + config.robot.arm.link_1.length + 0.03
    reach = target_shape(config.target).corner_circle
    return Extent(half_width, -0.75 * base.depth, config.target.initial_y + 1.06 * reach)


def _direction(elevation: float, azimuth: float) -> FloatArray:
    """Unit vector from the scene to a camera at that elevation, azimuth counted from -y."""
    level = math.cos(elevation)
    return np.array([level * math.sin(azimuth), -level * math.cos(azimuth), math.sin(elevation)])


def _distance(height: float, width: float, aspect: float) -> float:
    """How far off an extent of that apparent height and width fills the window [m]."""
    half = FILL * math.tan(FIELD_OF_VIEW / 2)
    return max(height / 2 / half, width / 2 / (half * aspect))


def perspective(config: MissionConfig, aspect: float) -> View:
    """From behind the robot and above, everything in sight."""
    area = extent(config)
    depth = area.front - area.rear
    apparent = depth * math.sin(ELEVATION) + 1.41 * target_shape(config.target).corner_circle * math.cos(ELEVATION)
    look_at = np.array([0.0, area.middle - 0.02, 0.05])
    distance = _distance(apparent, 2 * area.half_width, aspect) + depth / 8
    return View(look_at + distance * _direction(ELEVATION, AZIMUTH), look_at)


def top(config: MissionConfig, aspect: float) -> View:
    """Straight down, the robot's front upwards on the screen."""
    area = extent(config)
    look_at = np.array([0.0, area.middle, 0.05])
    distance = _distance(area.front - area.rear + 0.06, 2 * area.half_width, aspect) + 0.1
    # The screen's upward direction is that of the last lean, so a trace of it must stay.
    return View(look_at + np.array([0.0, -1e-3 * distance, distance]), look_at)


def close_up(point: Sequence[float], aspect: float) -> View:
    """Near a point in the plane of the hands."""
    look_at = np.array([point[0], point[1], 0.10])
    return View(look_at + _distance(0.26, 0.34, aspect) * _direction(math.radians(58), math.radians(-14)), look_at)


def carried(position: FloatArray, look_at: FloatArray, point: Sequence[float]) -> View:
    """A camera moved along so that it looks at a point in the plane, from the same side and distance."""
    target = np.array([point[0], point[1], look_at[2]])
    return View(position + (target - look_at), target)


def orientation(view: View) -> tuple[float, float, float, float]:
    """How that camera is turned, as a quaternion w, x, y, z: its x to the right, y down, z ahead; world z is up."""
    ahead = view.look_at - view.position
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    axes = np.column_stack([right, np.cross(ahead, right), ahead])
    w, x, y, z = SO3.from_matrix(axes).wxyz.tolist()
    return w, x, y, z

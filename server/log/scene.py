"""Robot and target as markers that hang on the frames of `/tf`: sent once, moved by the transforms."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any

import numpy as np

from server.log.ros import header, ros, serialized, store
from sim.capture.tick import ARMS
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.model.robot import robot_model
from sim.model.shape import Shape, outline
from sim.model.target import target_shape

MARKERS = "visualization_msgs/msg/MarkerArray"
_CUBE, _SPHERE, _CYLINDER, _TRIANGLES = 1, 2, 3, 11
_SHELL, _ARM, _TIP, _TARGET = (0.85, 0.86, 0.88), (0.45, 0.50, 0.56), (0.95, 0.55, 0.15), (0.80, 0.66, 0.25)
_HEIGHT = 0.06


def scene(config: MissionConfig) -> bytes:
    """A MarkerArray of base, links, tips and target."""
    robot, base = robot_model(config.robot), config.robot.base
    arm, thickness = config.robot.arm, 2 * config.robot.arm.link_radius
    markers: list[tuple[Any, ...]] = [
        ("base", _CUBE, (0.0, -base.centre_of_mass_ahead), 0.0, (base.width, base.depth, _HEIGHT), _SHELL),
        ("target", _TRIANGLES, (0.0, 0.0), 0.0, (1.0, 1.0, 1.0), _TARGET, prism(target_shape(config.target))),
    ]
    for name in ARMS:
        for link in range(3):
            length = float(robot.link_length[link])
            size = (thickness, thickness, length)
            markers.append((f"{name}_link_{link + 1}", _CYLINDER, (0.0, length / 2), -math.pi / 2, size, _ARM))
        for x in (-robot.tip_offset, robot.tip_offset):
            size = (2 * robot.tip_radius,) * 3
            markers.append((f"{name}_hand", _SPHERE, (x, 0.0), 0.0, size, _TIP))
        bar = (2 * robot.tip_offset, thickness, thickness)
        markers.append((f"{name}_hand", _CUBE, (0.0, -arm.hand.centre_offset / 2), 0.0, bar, _ARM))
    return serialized(ros(MARKERS, [_marker(number, *each) for number, each in enumerate(markers)]), MARKERS)


def prism(shape: Shape) -> FloatArray:
    """A shape with a height: the corners of triangles, counter-clockwise from outside, shape (n, 3) [m]."""
    low, high = (np.insert(outline(shape), 2, z, axis=1) for z in (-_HEIGHT / 2, _HEIGHT / 2))
    triangles: list[FloatArray] = []
    for place in range(len(low)):
        after = (place + 1) % len(low)
        triangles += [low[place], low[after], high[after], low[place], high[after], high[place]]
        if 0 < place < len(low) - 1:
            triangles += [high[0], high[place], high[after], low[0], low[after], low[place]]
    return np.array(triangles)


def _marker(
    number: int,
    frame: str,
    kind: int,
    place: tuple[float, float],
    lean: float,
    size: tuple[float, ...],
    colour: tuple[float, float, float],
    triangles: FloatArray | None = None,
) -> Any:
    """One marker; `lean` turns it about x [rad], as a cylinder stands along z."""
    point = ros("geometry_msgs/msg/Point", *place, 0.0)
    turned = ros("geometry_msgs/msg/Quaternion", math.sin(lean / 2), 0.0, 0.0, math.cos(lean / 2))
    values = {
        "header": header(frame, 0, 0),
        "ns": "becalm",
        "id": number,
        "type": kind,
        "action": 0,
        "pose": ros("geometry_msgs/msg/Pose", point, turned),
        "scale": ros("geometry_msgs/msg/Vector3", *size),
        "color": ros("std_msgs/msg/ColorRGBA", *colour, 1.0),
        "lifetime": ros("builtin_interfaces/msg/Duration", 0, 0),
        "frame_locked": True,
        "points": [] if triangles is None else [ros("geometry_msgs/msg/Point", *corner) for corner in triangles],
        "colors": [],
        "texture_resource": "",
        "texture": ros("sensor_msgs/msg/CompressedImage", header("", 0, 0), "", np.empty(0, np.uint8)),
        "uv_coordinates": [],
        "text": "",
        "mesh_resource": "",
        "mesh_file": ros("visualization_msgs/msg/MeshFile", "", np.empty(0, np.uint8)),
        "mesh_use_embedded_materials": False,
    }
    name = "visualization_msgs/msg/Marker"
    return ros(name, *(values[each.name] for each in fields(store().types[name]) if each.name in values))

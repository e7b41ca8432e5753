"""Arrows to scale, and the legend on the table that gives the scale."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import viser

from server.scene.canvas import Canvas
from server.scene.figures import lettering, raised, solid_line
from server.scene.palette import FAINT, Colour
from server.scene.solids import FloatArray

FORCE_SCALE = 0.15
"""Length of a force arrow [m/N]."""
MOMENTUM_SCALE = 1.0
"""Length of a momentum arrow [m/(N s)]."""
SHORTEST_ARROW = 0.003
"""Arrows below this length are not drawn [m]."""
SHAFT_RADIUS, HEAD_RADIUS, HEAD_LENGTH = 0.0030, 0.0090, 0.022
LARGEST_HEAD = 0.6
"""Share of a short arrow that its head may take, so that its length stays true."""


class Legend(NamedTuple):
    """An arrow lying on the table beside the robot, with what its length stands for."""

    text: str
    length: float
    x: float
    y: float


FORCE_LEGEND = Legend("1 N", FORCE_SCALE, 0.30, -0.13)
MOMENTUM_LEGEND = Legend("0.1 N s", 0.1 * MOMENTUM_SCALE, 0.30, -0.185)


def add_arrows(canvas: Canvas, name: str, colour: Colour) -> viser.ArrowsHandle:
    """Arrows yet to be pointed; hidden until then."""
    return canvas.scene.add_arrows(
        name,
        np.zeros((1, 2, 3)),
        colour,
        shaft_radius=SHAFT_RADIUS,
        head_radius=HEAD_RADIUS,
        head_length=HEAD_LENGTH,
        visible=False,
    )


def point_arrows(arrows: viser.ArrowsHandle, points: FloatArray) -> None:
    """Draws these arrows, shape (arrows, 2, 3); hides them all if there are none."""
    arrows.visible = len(points) > 0
    if not arrows.visible:
        return
    shortest = float(np.linalg.norm(points[:, 1] - points[:, 0], axis=1).min())
    head = min(1.0, LARGEST_HEAD * shortest / HEAD_LENGTH)
    arrows.head_length = round(head * HEAD_LENGTH, 4)
    arrows.head_radius = round(max(head, 0.6) * HEAD_RADIUS, 4)
    arrows.points = points.astype(np.float32)


def add_legend(canvas: Canvas, layer: str, legend: Legend, colour: Colour) -> None:
    """Lays a legend on the table; it belongs to the layer."""
    name = f"/legend_{layer}"
    canvas.group(layer, name)
    arrow = add_arrows(canvas, f"{name}/arrow", colour)
    ends = np.array([[legend.x, legend.y], [legend.x + legend.length, legend.y]])
    point_arrows(arrow, raised(ends, 0.006)[None])
    strokes = lettering(legend.text, legend.x, legend.y + 0.014, 0.018)
    lines = np.concatenate([solid_line(raised(stroke, 0.0025)) for stroke in strokes])
    canvas.scene.add_line_segments(f"{name}/text", lines, FAINT, thickness=0.0022)

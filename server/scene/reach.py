"""How far each wrist reaches: beyond it no plan leads."""

from __future__ import annotations

import math

import numpy as np

from server.scene.canvas import Canvas
from server.scene.figures import SIDES, arc_points, base_place, dashed_line, raised
from server.scene.palette import ARMS
from sim.capture.tick import ARMS as ARM_NAMES
from sim.config import MissionConfig
from sim.snapshot import Snapshot

_HEIGHT = 0.004
"""Over the table [m]."""
_SWEEP = math.radians(200.0)
"""Of an arc, ahead of the base."""
_DASH, _GAP = 0.014, 0.010


class ReachDrawing:
    """An arc about each shoulder, as far as its wrist comes with the arm stretched: links 1 and 2."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        base, arm = config.robot.base, config.robot.arm
        self._ahead = base.centre_of_mass_ahead
        canvas.group("reach", "/reach")
        self._base = canvas.frame("/reach/base")
        radius = arm.link_1.length + arm.link_2.length
        arc = arc_points(radius, math.pi / 2 - _SWEEP / 2, _SWEEP, 120)
        for name, colour, side in zip(ARM_NAMES, ARMS, SIDES, strict=True):
            shoulder = np.array([side * base.width / 2, base.depth / 2])
            points = raised(arc + shoulder, _HEIGHT)
            dashes = dashed_line(points, _DASH, _GAP)
            canvas.scene.add_line_segments(f"/reach/base/{name}", dashes, colour, thickness=0.002)

    def show(self, snapshot: Snapshot) -> None:
        """Moves the arcs with the base."""
        self._base.move(base_place(snapshot.base.pose, self._ahead))

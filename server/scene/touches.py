"""Where both hands will press on the target: the sides chosen, and the first point of each."""

from __future__ import annotations

import numpy as np
import viser

from server.scene.canvas import Canvas
from server.scene.figures import raised, solid_line
from server.scene.glb import Part
from server.scene.palette import ARMS, light
from server.scene.solids import ball
from server.scene.target import half_height, work_height
from sim.capture.tick import ARMS as ARM_NAMES
from sim.config import MissionConfig
from sim.model.target import seen_target_shape, to_middle
from sim.record import record_of
from sim.snapshot import PlannedTouch, Snapshot, Vector2

_SIDE, _POINT = 0.0042, 0.0062
"""Thickness of a side's line, and radius of a point [m]."""
_ABOVE = 0.004
"""The target's top [m]: what is drawn there is seen from above and from aside."""

Marks = tuple[tuple[Vector2, Vector2, Vector2], ...]
"""Of each hand: the ends of its side, and the point on it [m]."""


def marks_of(touch: PlannedTouch | None) -> Marks:
    """What of a planned touch is drawn; nothing of none. What changes while the hands press is not among it."""
    if touch is None:
        return ()
    return (*touch.left_side, touch.left_point), (*touch.right_side, touch.right_point)


class TouchDrawing:
    """The sides that hands will press on, each in its hand's colour, with the point that is touched first."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        shape = seen_target_shape(config.target)
        self._canvas, self._target = canvas, record_of(config.target)
        self._above = half_height(shape) + _ABOVE
        canvas.group("plan", "/touch")
        self._middle = canvas.frame("/touch/middle", work_height(shape))
        self._nodes: list[viser.SceneNodeHandle] = []
        self._marks: Marks = ()

    def show(self, snapshot: Snapshot) -> None:
        """Moves the marks with the target, and draws them where another touch is planned."""
        marks = marks_of(snapshot.plan.touch if snapshot.plan is not None else None)
        if marks != self._marks:
            self._marks = marks
            self._draw()
        if marks:
            pose, twist = np.array(snapshot.target.pose), np.zeros(3)
            to_middle(self._target, pose, twist)
            self._middle.move(pose.tolist())

    def _draw(self) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes = []
        for name, colour, (start, end, point) in zip(ARM_NAMES, ARMS, self._marks, strict=False):
            line = solid_line(raised(np.array([start, end]), self._above))
            self._nodes.append(
                self._canvas.scene.add_line_segments(f"/touch/middle/{name}_side", line, colour, thickness=_SIDE)
            )
            dot: list[Part] = [(ball(_POINT).moved(*point, self._above), light(colour))]
            self._nodes.append(self._canvas.parts(f"/touch/middle/{name}_point", dot, shadow=False))

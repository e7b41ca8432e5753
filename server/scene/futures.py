"""What may come, as a rehearsal foretells it: a bundle of ways, the most likely one with its end, and the worst."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import viser

from server.scene.canvas import Canvas, Moving
from server.scene.figures import raised, solid_line
from server.scene.machine import goal_hand_parts
from server.scene.palette import ARMS, FUTURE, NIGHT, TARGET, WORST, Colour
from server.scene.solids import FloatArray
from server.scene.target import work_height
from server.scene.traces import add_ghost
from sim.capture.tick import ARMS as ARM_NAMES
from sim.config import MissionConfig
from sim.model.target import target_shape
from sim.rehearsal.summary import CaseResult, Path
from sim.snapshot import Snapshot

_SPACING = 0.004
"""Between two points of a way that are drawn [m]."""
_ABOVE = 0.002
"""How far above the others the ways lie that matter more [m]."""
_BODIES: tuple[tuple[str, Colour], ...] = (
    ("target", TARGET),
    *((name, colour) for name, colour in zip(ARM_NAMES, ARMS, strict=True)),
)


class FuturesDrawing:
    """The ways of target and hands in the futures of one case, until the mission begins again."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        shape, hand = target_shape(config.target), config.robot.arm.hand
        self._canvas, self._height = canvas, work_height(shape)
        canvas.group("futures", "/futures")
        self._ghost = add_ghost(canvas, "/futures/target_end", shape, FUTURE)
        self._hands = [
            Moving(canvas.parts(f"/futures/{name}_end", goal_hand_parts(hand, FUTURE), shadow=False), self._height)
            for name in ARM_NAMES
        ]
        self._lines: list[viser.SceneNodeHandle] = []
        self._tick = -1
        self.foretell(None)

    def show(self, snapshot: Snapshot) -> None:
        """Forgets what was foretold of a mission that has begun again."""
        self.note(snapshot.tick)

    def note(self, tick: int) -> None:
        """The same, of a tick that is not drawn."""
        if tick < self._tick and self._lines:
            self.foretell(None)
        self._tick = tick

    def foretell(self, case: CaseResult | None) -> None:
        """Draws what the futures of a case say; nothing without one."""
        for line in self._lines:
            line.remove()
        self._lines = []
        likely = None if case is None else _of(case, case.most_likely)
        for end in (self._ghost, *self._hands):
            end.handle.visible = likely is not None
        if case is None or likely is None:
            return
        self._ghost.move(likely.target[-1])
        for hand, way in zip(self._hands, (likely.left, likely.right), strict=True):
            hand.move(way[-1])
        worst = _of(case, case.worst)
        others = [path for path in case.paths if path.future not in (case.most_likely, case.worst)]
        for body, colour in _BODIES:
            self._draw(f"bundle_{body}", [getattr(path, body) for path in others], _dimmed(colour), 0.0012, 0.0)
            self._draw(f"worst_{body}", [] if worst is None else [getattr(worst, body)], WORST, 0.003, _ABOVE)
            self._draw(f"likely_{body}", [getattr(likely, body)], FUTURE, 0.004, 2.0 * _ABOVE)

    def _draw(
        self, name: str, ways: Sequence[Sequence[Sequence[float]]], colour: Colour, thickness: float, above: float
    ) -> None:
        height = self._height + above
        segments = [solid_line(raised(_thinned(np.array(way)[:, :2]), height)) for way in ways if len(way) > 1]
        drawn = [each for each in segments if len(each)]
        if drawn:
            line = self._canvas.scene.add_line_segments(
                f"/futures/{name}", np.concatenate(drawn), colour, thickness=thickness
            )
            self._lines.append(line)


def _of(case: CaseResult, future: int) -> Path | None:
    """The way of that future; None if it is not among those that are drawn."""
    return next((path for path in case.paths if path.future == future), None)


def _thinned(points: FloatArray) -> FloatArray:
    """A way without the points that are nearer than the spacing to the one before, shape (n, 2); its end stays."""
    kept = [0]
    for place in range(1, len(points)):
        if np.hypot(*(points[place] - points[kept[-1]])) >= _SPACING or place == len(points) - 1:
            kept.append(place)
    return points[kept]


def _dimmed(colour: Colour) -> Colour:
    """Half as bright against the night."""
    red, green, blue = (round(0.5 * (a + b)) for a, b in zip(colour, NIGHT, strict=True))
    return red, green, blue
